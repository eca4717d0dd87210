/* The controller of an FMU that walks from its first tick on: see fmu.h. */
#include "fmu.h"

void ng_fmu_start_control(ng_fmu_memory *memory)
{
    const int leg = memory->integers[NG_FMU_FIRST_LEG];
    const ng_real limit = (ng_real)memory->reals[NG_FMU_TORQUE_LIMIT];
    memory->config = ng_config_of(&ng_laws[memory->integers[NG_FMU_LAW]]);
    memory->config.blend_s = (ng_real)memory->reals[NG_FMU_BLEND];
    for (int i = 0; i < NG_ACTUATED; ++i) {
        memory->config.torque_limit[i] = ng_clamp(limit, NG(0.0), ng_torque_limit[i]);
    }
#if NG_COMMANDS
    ng_real first[NG_COMMANDS];
    for (int i = 0; i < NG_COMMANDS; ++i) {
        first[i] = (ng_real)memory->reals[NG_FMU_COMMAND + i];
    }
    ng_start_at(&memory->state, leg, first);
#else
    ng_start(&memory->state, leg);
#endif
}

ng_state *ng_fmu_state(ng_fmu_memory *memory) { return &memory->state; }

int ng_fmu_walks(const ng_fmu_memory *memory)
{
    (void)memory;
    return 1;
}

void ng_fmu_control(ng_fmu_memory *memory, const ng_measurement *reading, ng_command *command,
                    ng_target targets[NG_LEGS][NG_LEG_JOINTS])
{
    const double *in = memory->reals;
    ng_step(&memory->config, &memory->state, reading, command);
    ng_impedance(reading, command, (ng_real)in[NG_FMU_KP], (ng_real)in[NG_FMU_KD], targets);
}
