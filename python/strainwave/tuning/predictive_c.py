"""C around the solver that OSQP generates: what a predictive controller remembers, and the data of its program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave.simulation.controller import MAX_SIGNAL

Array = NDArray[np.float64]

HEADER_TEXT = """\
/* A predictive controller of the position. Written by strainwave; the solver beside it is OSQP (Apache-2.0). */
#ifndef PREDICTIVE_H
#define PREDICTIVE_H

#define PREDICTIVE_HORIZON {horizon} /* periods that are planned */

typedef struct {{
    double input_angle, input_speed;   /* rad, rad/s */
    double output_angle, output_speed; /* rad, rad/s */
}} predictive_measured;

/* Forgets the motion so far. Call it before the first step. */
void predictive_reset(void);

/* Returns the actuation for angle [rad] and rate [rad/s] of the command at each instant of the horizon after now. */
double predictive_step(const predictive_measured *measured, const double angle[PREDICTIVE_HORIZON],
                       const double rate[PREDICTIVE_HORIZON]);

/* Number of periods in which the solver ran out of iterations; the plan before was continued there. */
extern int predictive_unsolved;

/* Number of calls with a number that is not finite or larger than {max_signal:g}; its last good value replaces it. */
extern int predictive_bad_samples;

#endif
"""

SOURCE_TEXT = """\
#include "predictive.h"

#include "osqp.h"
#include "workspace.h"

enum {{ STATES = {states}, HORIZON = PREDICTIVE_HORIZON, ROWS = {rows}, PARAMETERS = {parameters} }};

{constants}
{arrays}
int predictive_unsolved, predictive_bad_samples;

static predictive_measured good;
static double good_angle[HORIZON], good_rate[HORIZON];
static double plan[HORIZON], bias[STATES], predicted[STATES + 1];
static int is_first = 1;

void predictive_reset(void) {{
    static const predictive_measured zero;
    int i;
    good = zero;
    for (i = 0; i < HORIZON; ++i) good_angle[i] = good_rate[i] = 0.0;
    for (i = 0; i < HORIZON; ++i) plan[i] = 0.0;
    for (i = 0; i < STATES; ++i) bias[i] = 0.0;
    for (i = 0; i <= STATES; ++i) predicted[i] = 0.0;
    is_first = 1;
    predictive_unsolved = predictive_bad_samples = 0;
    osqp_cold_start(&solver);
}}

/* Sum of a row of a matrix times a vector. */
static double product(const double *row, const double *vector, int count) {{
    double sum = 0.0;
    int i;
    for (i = 0; i < count; ++i) sum += row[i] * vector[i];
    return sum;
}}

static double absolute(double value) {{ return value < 0.0 ? -value : value; }}

/* Replaces the last good value by a new one, if this is good. Returns 1 if it is not. */
static int held(double *last, double value) {{
    if (!(absolute(value) <= max_signal)) return 1;
    *last = value;
    return 0;
}}

static int solved(void) {{
    return solver.info->status_val == OSQP_SOLVED || solver.info->status_val == OSQP_SOLVED_INACCURATE;
}}

static void planned(const double *parameters) {{
    static double shifted[ROWS], low[ROWS], high[ROWS], unlimited[HORIZON];
    static double cost[ROWS]; /* 0 for what exceeds a limit */
    int i, is_free = 1;
    for (i = 0; i < HORIZON; ++i) cost[i] = product(gradient + i * PARAMETERS, parameters, PARAMETERS);
    for (i = 0; i < ROWS; ++i) {{
        shifted[i] = product(shift + i * PARAMETERS, parameters, PARAMETERS);
        low[i] = -bound[i] - shifted[i];
        high[i] = bound[i] - shifted[i];
    }}
    for (i = 0; i < HORIZON; ++i) unlimited[i] = product(free_plan + i * PARAMETERS, parameters, PARAMETERS);
    for (i = 0; i < ROWS; ++i) {{
        if (absolute(product(rows + i * HORIZON, unlimited, HORIZON) + shifted[i]) > bound[i]) is_free = 0;
    }}
    if (is_free) {{
        for (i = 0; i < HORIZON; ++i) plan[i] = unlimited[i];
        return;
    }}
    osqp_update_data_vec(&solver, cost, low, high);
    osqp_solve(&solver);
    if (!solved()) {{
        ++predictive_unsolved;
        for (i = 0; i + 1 < HORIZON; ++i) plan[i] = plan[i + 1];
        return;
    }}
    for (i = 0; i < HORIZON; ++i) {{
        const double value = solver.solution->x[i];
        plan[i] = value > bound[0] ? bound[0] : value < -bound[0] ? -bound[0] : value;
    }}
}}

static void states_of(const predictive_measured *measured, double states[STATES]) {{
    const double input_angle = measured->input_angle, input_speed = measured->input_speed;
    const double output_speed = measured->output_speed, transmission_error = input_angle / ratio - measured->output_angle;
    const double values[STATES] = {{{names}}};
    int i;
    for (i = 0; i < STATES; ++i) states[i] = values[i];
}}

double predictive_step(const predictive_measured *measured, const double angle[PREDICTIVE_HORIZON],
                       const double rate[PREDICTIVE_HORIZON]) {{
    static double parameters[PARAMETERS];
    double states[STATES], actuation;
    int i, bad = held(&good.input_angle, measured->input_angle) | held(&good.input_speed, measured->input_speed) |
                 held(&good.output_angle, measured->output_angle) | held(&good.output_speed, measured->output_speed);
    for (i = 0; i < HORIZON; ++i) bad |= held(&good_angle[i], angle[i]) | held(&good_rate[i], rate[i]);
    predictive_bad_samples += bad;
    states_of(&good, states);
    for (i = 0; i < STATES; ++i) {{
        if (!is_first) bias[i] += share * (states[i] - predicted[i] - bias[i]);
        parameters[i] = states[i];
        parameters[STATES + 1 + i] = bias[i];
    }}
    is_first = 0;
    parameters[STATES] = predicted[STATES];
    for (i = 0; i < HORIZON; ++i) {{
        parameters[2 * STATES + 1 + i] = good_angle[i];
        parameters[2 * STATES + 1 + HORIZON + i] = good_rate[i];
    }}
    planned(parameters);
    actuation = plan[0] * effort;
    for (i = 0; i <= STATES; ++i) {{
        predicted[i] = product(step + i * (STATES + 1), parameters, STATES + 1) + input[i] * actuation;
    }}
    return actuation;
}}
"""


def write_c(
    folder: Path, states: Sequence[str], horizon: int, constants: dict[str, float], arrays: Mapping[str, Array]
) -> None:
    """Write `predictive.h` and `predictive.c` into the folder of the solver."""
    count, parameters = arrays["shift"].shape
    source = SOURCE_TEXT.format(
        states=len(states),
        rows=count,
        parameters=parameters,
        names=", ".join(states),
        constants="\n".join(
            f"static const double {name} = {value!r};" for name, value in (constants | {"max_signal": MAX_SIGNAL}).items()
        ),
        arrays="\n".join(f"static const double {name}[] = {{\n{_numbers(array)}}};" for name, array in arrays.items()),
    )
    (folder / "predictive.h").write_text(HEADER_TEXT.format(horizon=horizon, max_signal=MAX_SIGNAL), encoding="utf-8")
    (folder / "predictive.c").write_text(source, encoding="utf-8")


def _numbers(array: Array) -> str:
    """Return the numbers of an array, eight a line."""
    flat = [repr(value) for value in array.ravel().tolist()]
    return "".join("    " + ", ".join(flat[begin : begin + 8]) + ",\n" for begin in range(0, len(flat), 8))
