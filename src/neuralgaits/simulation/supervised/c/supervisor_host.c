/*
 * The supervisor behind arrays of doubles, in either precision, for a host in another language.
 * The caller owns all memory.
 */
#include <stddef.h>
#include <string.h>

#include "estimator.h"
#include "supervisor.h"

#define JOINTS (NG_LEGS * NG_LEG_JOINTS)

typedef struct {
    ng_supervisor_config config;
    ng_supervisor supervisor;
    ng_estimator estimator;
    int estimate; /* whether rates and velocity are not measured */
} ng_host;

size_t ng_host_bytes(void);
void ng_host_start(ng_host *host, int law, int estimate);
void ng_host_tell(ng_host *host, const double *requested);
void ng_host_tick(ng_host *host, uint32_t time_us, const double *sensors, int request,
                  double *decided, double *targets, double *torques);

size_t ng_host_bytes(void) { return sizeof(ng_host); }

void ng_host_start(ng_host *host, int law, int estimate)
{
    memset(host, 0, sizeof *host);
    host->config = ng_supervisor_config_of(&ng_laws[law]);
    host->estimate = estimate;
    ng_supervisor_start(&host->supervisor);
    ng_estimator_start(&host->estimator);
}

/* Commands of a gait that takes some, NG_COMMANDS of them. */
void ng_host_tell(ng_host *host, const double *requested)
{
#if NG_COMMANDS
    ng_real command[NG_COMMANDS];
    for (int i = 0; i < NG_COMMANDS; ++i) {
        command[i] = (ng_real)requested[i];
    }
    ng_tell(&host->supervisor.state, command);
#else
    (void)host;
    (void)requested;
#endif
}

static const double *take(const double *from, ng_real *to, int count)
{
    for (int i = 0; i < count; ++i) {
        to[i] = (ng_real)from[i];
    }
    return from + count;
}

/*
 * sensors: pitch, its rate, velocity (x, z), force on each foot, joints, their rates. decided: mode,
 * reason, what the request waits for, fault, whether it is new, leg, touchdown, z, time since a
 * touchdown. targets: the five
 * numbers of each joint. torques: of the file's joints [N m].
 */
void ng_host_tick(ng_host *host, uint32_t time_us, const double *sensors, int request,
                  double *decided, double *targets, double *torques)
{
    ng_encoders encoders;
    ng_measurement reading;
    ng_supervision now;
    encoders.time_us = time_us;
    sensors = take(sensors, &encoders.pitch, 1);
    sensors = take(sensors, &encoders.dpitch, 1);
    sensors = take(sensors, encoders.base_velocity, 2);
    sensors = take(sensors, encoders.normal_force, NG_LEGS);
    sensors = take(sensors, &encoders.joints[0][0], JOINTS);
    take(sensors, &encoders.djoints[0][0], JOINTS);
    ng_measure(&encoders, &reading);
    if (host->estimate) {
        ng_estimate(&host->estimator, &host->supervisor.state, &reading);
    }
    ng_supervise(&host->config, &host->supervisor, &reading, (ng_request)request, &now);
    const double found[] = {now.mode,         now.reason,        now.waiting,
                            now.fault,        now.fault_is_new,  now.command.leg,
                            now.command.touchdown, now.command.z[0], now.command.z[1],
                            now.command.since_touchdown};
    memcpy(decided, found, sizeof found);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_target *to = &host->supervisor.targets[leg][i];
            const double five[] = {to->q_des, to->dq_des, to->kp, to->kd, to->tau_ff};
            memcpy(targets, five, sizeof five);
            targets += 5;
            *torques++ = ng_joint_sign[leg][i] * now.command.torque[leg][i];
        }
    }
}
