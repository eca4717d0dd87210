/*
 * A quadratic program in place of clipping: neuralgaits.control.clf_qp and .interior_point again,
 * number for number but for rounding. For ng_law's `apply_limits`, whose `own` is an ng_clf_qp.
 */
#ifndef NG_CLF_QP_H
#define NG_CLF_QP_H

#include "controller.h"

#define NG_QP_UNKNOWNS (NG_ACTUATED + 2)
#define NG_QP_ROWS (2 * NG_ACTUATED + 4)

/* What the program asks; see ClfQp in Python. */
typedef struct {
    double bandwidth;     /* w of the Lyapunov function [rad/s] */
    double price;         /* of a slower decrease [(N m)^2 / (rad/s)^2] */
    double contact_price; /* of forces that a floor does not give [(N m)^2 a squared weight] */
    double friction;      /* coefficient of the floor */
    double least_normal;  /* force, as a share of the weight */
} ng_clf_qp;

/* Torques within limits in place of those in command->actuated. Returns whether any is at one. */
int ng_clf_qp_apply_limits(const ng_config *config, const ng_desired *wanted, ng_command *command);

#endif
