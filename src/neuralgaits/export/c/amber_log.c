/* See amber_log.h. Columns: neuralgaits.logs.formats.amber3m. */
#include "amber_log.h"

#if NG_HAS_AMBER_LOG

/* Left knee, left hip, right hip, right knee. */
static void across(const ng_real (*by_leg)[NG_LEG_JOINTS], double row[4])
{
    row[0] = (double)by_leg[0][0];
    row[1] = (double)by_leg[0][1];
    row[2] = (double)by_leg[1][1];
    row[3] = (double)by_leg[1][0];
}

/* The same from values with the stance leg first. */
static void across_from_stance(const ng_real actuated[4], int leg, double row[4])
{
    for (int i = 0; i < 4; ++i) {
        row[i] = (double)actuated[leg == 0 ? i : 3 - i];
    }
}

static int names(FILE *file, const char *name, int count)
{
    int written = 0;
    for (int i = 1; i <= count && written >= 0; ++i) {
        written = fprintf(file, ",%s_%d", name, i);
    }
    return written;
}

int ng_amber_header(FILE *file)
{
    if (fputs("t,tau,switchBack,tau_d,tau_a,stance", file) < 0 || names(file, "a_state", 10) < 0 ||
        names(file, "d_state", 8) < 0 || names(file, "torque", 4) < 0 ||
        names(file, "d_torque", 4) < 0 || names(file, "position", 6) < 0) {
        return -1;
    }
    return fputc('\n', file) == EOF ? -1 : 0;
}

int ng_amber_row(FILE *file, double time_ms, const ng_measurement *reading,
                 const ng_command *command)
{
    /* Phase of the step: as measured, as the policy is told, and again as measured. */
    const double phase = (double)((command->z[0] - ng_z_lower[0]) / (ng_z_upper[0] - ng_z_lower[0]));
    const double told = phase < 0.0 ? 0.0 : phase > 1.0 ? 1.0 : phase;
    double row[38] = {time_ms, phase, command->touchdown ? 1.0 : 0.0, told, phase,
                      command->leg == 1 ? 1.0 : 0.0, (double)reading->pitch};
    ng_real foot[2], hip[2];
    across(reading->angles, row + 7);
    row[11] = (double)reading->dpitch;
    across(reading->rates, row + 12);
    across_from_stance(command->y_d, command->leg, row + 16);
    across_from_stance(command->dy_d, command->leg, row + 20);
    for (int i = 0; i < 4; ++i) {
        const int leg = i / 2, joint = leg == 0 ? i : 3 - i;
        row[24 + i] = (double)command->torque[leg][joint];
    }
    across_from_stance(command->actuated, command->leg, row + 28);
    /* Left foot, right foot and hip from the stance foot, (x, z). */
    ng_feet(command->q, foot, hip);
    for (int i = 0; i < 2; ++i) {
        row[32 + 2 * (1 - command->leg) + i] = (double)foot[i];
        row[36 + i] = (double)hip[i];
    }
    for (int i = 0; i < 38; ++i) {
        if (fprintf(file, i == 0 ? "%.9g" : ",%.9g", row[i]) < 0) {
            return -1;
        }
    }
    return fputc('\n', file) == EOF ? -1 : 0;
}

#else
typedef int ng_no_amber_log; /* a file must not be empty */
#endif
