/* The controller of an FMU that stands first, walks and stops on request: see fmu.h. */
#include "fmu.h"

#include <string.h>

void ng_fmu_start_control(ng_fmu_memory *memory)
{
    const ng_real limit = (ng_real)memory->reals[NG_FMU_TORQUE_LIMIT];
    memory->config = ng_supervisor_config_of(&ng_laws[memory->integers[NG_FMU_LAW]]);
    for (int i = 0; i < NG_ACTUATED; ++i) {
        memory->config.walk.torque_limit[i] = ng_clamp(limit, NG(0.0), ng_torque_limit[i]);
    }
    ng_supervisor_start(&memory->supervisor);
#if NG_COMMANDS
    ng_real first[NG_COMMANDS];
    for (int i = 0; i < NG_COMMANDS; ++i) {
        first[i] = (ng_real)memory->reals[NG_FMU_COMMAND + i];
    }
    ng_start_at(&memory->supervisor.state, 0, first);
#endif
}

ng_state *ng_fmu_state(ng_fmu_memory *memory) { return &memory->supervisor.state; }

int ng_fmu_walks(const ng_fmu_memory *memory) { return memory->supervisor.mode == NG_WALK; }

void ng_fmu_control(ng_fmu_memory *memory, const ng_measurement *reading, ng_command *command,
                    ng_target targets[NG_LEGS][NG_LEG_JOINTS])
{
    ng_supervision decided;
    ng_supervise(&memory->config, &memory->supervisor, reading,
                 (ng_request)memory->integers[NG_FMU_REQUEST], &decided);
    *command = decided.command;
    command->fault = decided.fault;
    memcpy(targets, memory->supervisor.targets, sizeof memory->supervisor.targets);
    memory->integers[NG_FMU_MODE] = (int32_t)decided.mode;
    memory->integers[NG_FMU_WAITING] = (int32_t)decided.waiting;
    if (decided.reason != NG_NO_CHANGE) {
        memory->integers[NG_FMU_REASON] = (int32_t)decided.reason;
    }
}
