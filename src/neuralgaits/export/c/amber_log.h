/* Log rows in the format of AMBER-3M: 38 columns, milliseconds. For hosts with stdio. */
#ifndef NG_AMBER_LOG_H
#define NG_AMBER_LOG_H

#include <stdio.h>

#include "controller.h"

#if NG_HAS_TORSO && NG_LEG_JOINTS == 2
#define NG_HAS_AMBER_LOG 1

/* The row of names. Returns a negative number if it cannot be written. */
int ng_amber_header(FILE *file);

/* One tick; leg 0 is the left one. Returns a negative number if it cannot be written. */
int ng_amber_row(FILE *file, double time_ms, const ng_measurement *reading,
                 const ng_command *command);

#else
#define NG_HAS_AMBER_LOG 0 /* the format is for a torso and two joints a leg */
#endif

#endif
