"""One tick of the exported controller of the biped in three dimensions, in C: its time.

    space_tick.py RUN [RUN ...]

Readings are those of a walk in MuJoCo, a step long, met again and again by both precisions; times
are medians of blocks of 1000 ticks.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from common import show

from neuralgaits._compiler import Compiler
from neuralgaits.programs.c99.constant_arrays import braces
from neuralgaits.systems.controller_export import export_family
from neuralgaits.systems.family_run import FamilyRun, open_family_run
from neuralgaits.systems.walker3d.live_controllers import controller_of
from neuralgaits.systems.walker3d.live_walk import SpatialLive
from neuralgaits.systems.walker3d.spatial_system import SYSTEM

BLOCKS, TICKS = 101, 1000
MAIN = """
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "walker3d_tick.h"
%s
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}
static int by_size(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}
int main(void) {
  static double times[%d];
  ng_walker3d robot;
  ng_real torques[6];
  int lost = 0;
  for (int block = 0; block < %d; ++block) {
    const double begun = now();
    for (int i = 0; i < %d; ++i) {
      const ng_real *row = rows[i %% COUNT];
      ng_walker3d_reading r = {.roll = row[0], .pitch = row[1], .roll_rate = row[8],
                               .pitch_rate = row[9], .velocity_known = 1};
      for (int j = 0; j < 6; ++j) r.joints[j] = row[2 + j], r.rates[j] = row[10 + j];
      for (int j = 0; j < 3; ++j) r.velocity[j] = row[16 + j];
      if (i %% COUNT == 0) ng_walker3d_start(&robot, 0);
      lost += ng_walker3d_tick(&robot, &r, torques);
    }
    times[block] = (now() - begun) / %d;
  }
  qsort(times, %d, sizeof(double), by_size);
  printf("%%g %%d\\n", times[%d] / 1000.0, lost);
  return 0;
}
"""


def readings(run: FamilyRun) -> np.ndarray:
    """Joints, rates and velocity at each tick of a step in MuJoCo. [N, 19]."""
    live, rows = SpatialLive(run), []
    live.control_with(controller_of(run))
    while live.tick() and live.steps == 0:
        q, dq, velocity = live.plants.readings()
        rows.append(np.concatenate([q[0], dq[0], velocity[0]]))
    return np.array(rows)


def main() -> None:
    """Print the table."""
    compiler = Compiler.for_c()
    if compiler is None:
        raise SystemExit("expected a C compiler, found none")
    for name in sys.argv[1:]:
        run = open_family_run(SYSTEM, name)
        rows = readings(run)
        table = f"#define COUNT {len(rows)}\nstatic const ng_real rows[COUNT][19] = {braces(rows)};"
        for precision, flag in (("double", ()), ("single", ("-DNG_FLOAT",))):
            with tempfile.TemporaryDirectory() as place:
                folder = Path(place) / "c"
                export_family(SYSTEM, run, folder)
                sizes = table, BLOCKS, BLOCKS, TICKS, TICKS, BLOCKS, BLOCKS // 2
                (folder / "main.c").write_text(MAIN % sizes)
                sources = [str(one) for one in sorted(folder.glob("*.c"))]
                made = folder / "ticks"
                line = ["cc", "-std=c99", "-O2", *flag, *sources, "-o", str(made)]
                subprocess.run(line, check=True)
                took, lost = subprocess.check_output([made], text=True).split()
            show(f"{Path(name).name}: a tick, {precision}, us (lost {lost})", float(took), "20")


if __name__ == "__main__":
    main()
