/* The loop of docs/deploy.md as a library: raw readings in, torques of drives out. */
#include "board_map.h"
#include "estimator.h"

static ng_config config;
static ng_state state;
static ng_estimator estimator;

void begin(int leg)
{
    config = ng_config_of(&ng_laws[NG_LAW_PD]);
    ng_start(&state, leg);
    ng_estimator_start(&estimator);
}

/* in: positions of the drives, pitch, contacts. out: torques, touchdown, fault. */
void tick(uint32_t time_us, const double *in, double *out)
{
    ng_board_readings readings = {0};
    ng_encoders encoders;
    ng_measurement reading;
    ng_command command;
    ng_real torques[NG_BOARD_MOTORS];
    readings.time_us = time_us;
    for (int i = 0; i < NG_BOARD_MOTORS; ++i) {
        readings.position[i] = (ng_real)*in++;
    }
    readings.pitch = (ng_real)*in++;
    for (int i = 0; i < NG_BOARD_CHANNELS; ++i) {
        readings.contact[i] = (ng_real)*in++;
    }
    (void)ng_board_encoders(&readings, &encoders);
    ng_measure(&encoders, &reading);
    ng_estimate(&estimator, &state, &reading);
    ng_step(&config, &state, &reading, &command);
    ng_board_torques(&command, torques);
    for (int i = 0; i < NG_BOARD_MOTORS; ++i) {
        *out++ = (double)torques[i];
    }
    *out++ = (double)command.touchdown;
    *out++ = (double)command.fault;
}
