/* See clf_qp.h. Sources of the mathematics stand in the Python that this repeats. */
#include "clf_qp.h"

#include <math.h>
#include <string.h>

#define N NG_COORDINATES
#define M NG_ACTUATED
#define V NG_QP_UNKNOWNS
#define K NG_QP_ROWS
#define COLUMNS (M + 1)

#define ROUNDS 30
#define GAP 1.0e-11
#define CLOSED 1.0e-10
#define SHORT_OF_BOUND 0.995
#define DECAY 0.75
#define SMALLEST_OUTPUT 1.0e-9 /* [rad] */
#define AT_LIMIT 1.0e-6
#define SLOWER 1.0e-3          /* [rad/s] */
#define OUT_OF_CONE 1.0e-3     /* shares of the weight */

/* Minimise sum_i (weight_i x_i^2 / 2 + cost_i x_i) so that rows x <= bound. */
typedef struct {
    double weight[V], cost[V], rows[K][V], bound[K];
} program;

typedef struct {
    double x[V], slack[K], multiplier[K];
} point;

/* Gauss-Jordan elimination for a positive definite matrix, as robots.linear has it. */
static void eliminate(int size, int columns, double *table, int width)
{
    for (int k = 0; k < size; ++k) {
        double *row = table + k * width;
        const double pivot = row[k];
        for (int j = k; j < size + columns; ++j) {
            row[j] /= pivot;
        }
        for (int i = 0; i < size; ++i) {
            double *other = table + i * width;
            const double factor = other[k];
            if (i == k) {
                continue;
            }
            for (int j = k; j < size + columns; ++j) {
                other[j] -= factor * row[j];
            }
        }
    }
}

static double gap(const point *at)
{
    double sum = 0.0;
    for (int k = 0; k < K; ++k) {
        sum += at->slack[k] * at->multiplier[k];
    }
    return sum / K;
}

/* Share of a step, at most 1, that leaves slacks and multipliers positive. */
static double longest(const point *at, const point *step)
{
    double share = 1.0;
    for (int k = 0; k < K; ++k) {
        if (step->slack[k] < 0.0 && -at->slack[k] / step->slack[k] < share) {
            share = -at->slack[k] / step->slack[k];
        }
        if (step->multiplier[k] < 0.0 && -at->multiplier[k] / step->multiplier[k] < share) {
            share = -at->multiplier[k] / step->multiplier[k];
        }
    }
    return share;
}

/* The Newton step that takes `product` from each slack times its multiplier. */
static void towards(const program *of, const point *at, const double dual[V],
                    const double primal[K], const double product[K], point *step)
{
    double table[V][V + 1];
    for (int i = 0; i < V; ++i) {
        for (int j = 0; j < V; ++j) {
            table[i][j] = i == j ? of->weight[i] : 0.0;
        }
        table[i][V] = -dual[i];
    }
    for (int k = 0; k < K; ++k) {
        const double stiff = at->multiplier[k] / at->slack[k];
        const double pull = (product[k] - at->multiplier[k] * primal[k]) / at->slack[k];
        for (int i = 0; i < V; ++i) {
            for (int j = 0; j < V; ++j) {
                table[i][j] += stiff * of->rows[k][i] * of->rows[k][j];
            }
            table[i][V] += of->rows[k][i] * pull;
        }
    }
    eliminate(V, 1, &table[0][0], V + 1);
    for (int i = 0; i < V; ++i) {
        step->x[i] = table[i][V];
    }
    for (int k = 0; k < K; ++k) {
        double change = -primal[k];
        for (int i = 0; i < V; ++i) {
            change -= of->rows[k][i] * step->x[i];
        }
        step->slack[k] = change;
        step->multiplier[k] = -(product[k] + at->multiplier[k] * change) / at->slack[k];
    }
}

/* One round of the predictor and the corrector. */
static void go_on(const program *of, point *at)
{
    double dual[V], primal[K], product[K], left = 0.0;
    const double now = gap(at);
    point ahead, step;
    for (int i = 0; i < V; ++i) {
        dual[i] = of->weight[i] * at->x[i] + of->cost[i];
    }
    for (int k = 0; k < K; ++k) {
        primal[k] = at->slack[k] - of->bound[k];
        for (int i = 0; i < V; ++i) {
            dual[i] += of->rows[k][i] * at->multiplier[k];
            primal[k] += of->rows[k][i] * at->x[i];
        }
        product[k] = at->slack[k] * at->multiplier[k];
    }
    towards(of, at, dual, primal, product, &ahead);
    const double far = longest(at, &ahead);
    for (int k = 0; k < K; ++k) {
        left += (at->slack[k] + far * ahead.slack[k]) *
                (at->multiplier[k] + far * ahead.multiplier[k]) / K;
    }
    const double share = left / now;
    for (int k = 0; k < K; ++k) {
        product[k] += ahead.slack[k] * ahead.multiplier[k] - share * share * share * now;
    }
    towards(of, at, dual, primal, product, &step);
    const double length = SHORT_OF_BOUND * longest(at, &step);
    for (int i = 0; i < V; ++i) {
        at->x[i] += length * step.x[i];
    }
    for (int k = 0; k < K; ++k) {
        at->slack[k] += length * step.slack[k];
        at->multiplier[k] += length * step.multiplier[k];
    }
}

/* Returns whether the gap was closed. */
static int minimise(const program *of, point *at)
{
    for (int i = 0; i < V; ++i) {
        at->x[i] = -of->cost[i] / of->weight[i];
    }
    for (int k = 0; k < K; ++k) {
        double slack = of->bound[k];
        for (int i = 0; i < V; ++i) {
            slack -= of->rows[k][i] * at->x[i];
        }
        at->slack[k] = slack > 1.0 ? slack : 1.0;
        at->multiplier[k] = 1.0;
    }
    for (int round = 0; round < ROUNDS && gap(at) >= GAP; ++round) {
        const point before = *at;
        go_on(of, at);
        if (gap(&before) < CLOSED && !(gap(at) < gap(&before))) {
            *at = before; /* Rounding has the last word. */
            break;
        }
    }
    return gap(at) < CLOSED;
}

/* Accelerations without torque, then by each torque [rad/s^2], [rad/s^2 a N m]. */
static void accelerations(const ng_command *command, double table[N][N + COLUMNS])
{
    double mass[N * N], bias[N];
    ng_dynamics(command->dq, NG_BELIEVED(&command->lean) command->q, bias, mass);
#if NG_ANKLES
    bias[0] += command->ankle - NG_ANKLE_DAMPING * command->dq[0];
#endif
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            table[i][j] = mass[i * N + j];
        }
        table[i][N] = -bias[i];
        for (int j = 1; j < COLUMNS; ++j) {
            table[i][N + j] = i == j ? 1.0 : 0.0;
        }
    }
    eliminate(N, COLUMNS, &table[0][0], N + COLUMNS);
}

/* The row of the Lyapunov function: how fast it changes, and what is left to its bound. */
static void decrease(const ng_clf_qp *own, const ng_desired *wanted, const ng_command *command,
                     double table[N][N + COLUMNS], double row[M], double *bound)
{
    const double w = own->bandwidth;
    double one[M], two[M], rate[M], squares = 0.0;
    for (int i = 0; i < M; ++i) {
        rate[i] = command->dq[i + 1] - wanted->dy[i];
        one[i] = rate[i] / w;
        two[i] = 2.0 * (command->q[i + 1] - wanted->y[i] + one[i]);
        squares += one[i] * one[i] + two[i] * two[i];
    }
    const double size = sqrt(squares);
    const double divisor = size > SMALLEST_OUTPUT ? size : SMALLEST_OUTPUT;
    *bound = -DECAY * w * size;
    for (int j = 0; j < M; ++j) {
        row[j] = 0.0;
    }
    for (int j = 0; j < COLUMNS; ++j) {
        double ddz1 = 0.0;
        for (int i = 0; i < N; ++i) {
            ddz1 += ng_hip_gradient[i] * table[i][N + j];
        }
        for (int i = 0; i < M; ++i) {
            const double lead = (one[i] + 2.0 * two[i]) / (w * divisor);
            const double ddy = table[i + 1][N + j] - wanted->slope[i] * ddz1;
            if (j == 0) {
                *bound -= lead * (ddy - wanted->drift[i]) + 2.0 * two[i] * rate[i] / divisor;
            } else {
                row[j - 1] += lead * ddy;
            }
        }
    }
}

/* Forces of the floor on the foot without torque, then by each torque, (x, z) [shares]. */
static void forces(const ng_command *command, double table[N][N + COLUMNS],
                   double force[2][COLUMNS])
{
    double by[2 * N], still[2];
    ng_ground(command->dq, NG_BELIEVED(&command->lean) command->q, by, still);
    for (int a = 0; a < 2; ++a) {
        for (int j = 0; j < COLUMNS; ++j) {
            force[a][j] = j == 0 ? still[a] : 0.0;
            for (int i = 0; i < N; ++i) {
                force[a][j] += by[a * N + i] * table[i][N + j];
            }
        }
    }
}

int ng_clf_qp_apply_limits(const ng_config *config, const ng_desired *wanted, ng_command *command)
{
    const ng_clf_qp *own = config->law->own;
    double table[N][N + COLUMNS], row[M], force[2][COLUMNS], unit = 0.0;
    program of;
    point at;
    memset(&of, 0, sizeof of);
    accelerations(command, table);
    forces(command, table, force);
    for (int i = 0; i < M; ++i) {
        unit = config->torque_limit[i] > unit ? config->torque_limit[i] : unit;
    }
    for (int i = 0; i < M; ++i) {
        of.weight[i] = 1.0;
        of.cost[i] = -command->actuated[i] / unit;
        of.rows[i][i] = 1.0;
        of.rows[M + i][i] = -1.0;
        of.bound[i] = of.bound[M + i] = config->torque_limit[i] / unit;
    }
    of.weight[M] = own->price / (unit * unit);
    of.weight[M + 1] = own->contact_price / (unit * unit);
    double(*rows)[V] = of.rows + 2 * M, *bound = of.bound + 2 * M;
    decrease(own, wanted, command, table, row, bound);
    rows[0][M] = -1.0;
    bound[1] = force[1][0] - own->least_normal;
    bound[2] = own->friction * force[1][0] - force[0][0];
    bound[3] = own->friction * force[1][0] + force[0][0];
    for (int i = 0; i < M; ++i) {
        rows[0][i] = unit * row[i];
        rows[1][i] = -unit * force[1][i + 1];
        rows[2][i] = unit * (force[0][i + 1] - own->friction * force[1][i + 1]);
        rows[3][i] = unit * (-force[0][i + 1] - own->friction * force[1][i + 1]);
    }
    rows[1][M + 1] = rows[2][M + 1] = rows[3][M + 1] = -1.0;
    const int solved = minimise(&of, &at);
    int at_limit = 0;
    for (int i = 0; i < M; ++i) {
        const double limit = config->torque_limit[i];
        const double torque = solved ? unit * at.x[i] : command->actuated[i];
        command->actuated[i] = ng_clamp(torque, -limit, limit);
        at_limit |= fabs(command->actuated[i]) >= (1.0 - AT_LIMIT) * limit;
    }
    command->relaxed[0] = !solved || at.x[M] > SLOWER;
    command->relaxed[1] = !solved || at.x[M + 1] > OUT_OF_CONE;
    return at_limit;
}
