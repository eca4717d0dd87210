"""Conditions of the default spec on fresh samples, and what the real impact leaves of the outputs.

Asked: no violation, every margin at least 0.04 of its scale, on 100,000 points, seeds 0-19.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from common import seeds, show, trained

from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import Run
from neuralgaits.training import Sampler, lay_out, margin_matrix

COUNTS = {
    "tube": 60000,
    "lift-off": 6000,
    "swing": 6000,
    "landing": 6000,
    "fence-lower": 6000,
    "fence-upper": 6000,
    "guard": 10000,
}


def main() -> None:
    """Print one line a seed and the worst over all."""
    evaluate, worst, mismatches, orbits = None, {}, [], []
    for seed in seeds():
        run = trained("amber3m", seed)
        sampler = Sampler.plan(run.spec.regions, COUNTS)
        layout = lay_out(run.spec, run.robot, run.gait, sampler)
        if evaluate is None:
            evaluate = _margins_of(run)
        values = evaluate(run.gait, sampler.draw(jax.random.key(10**6 + seed)))
        share = np.where(layout.counts, np.asarray(values) / layout.scale, np.inf)
        smallest = {name: share[:, block].min() for name, block in layout.columns.items()}
        for name, value in smallest.items():
            worst[name] = min(worst.get(name, np.inf), value)
        mismatches.append(_mismatch(run))
        zd = run.zero_dynamics
        orbit = poincare(zd, run.gait.z(jnp.array([0.5, 0.5])))
        orbits.append(orbit)
        name = min(smallest, key=smallest.__getitem__)
        print(
            f"seed {seed:2d}  smallest margin {smallest[name]:.4f} ({name})  "
            f"speed {orbit.speed_m_s:.3f} m/s  multiplier {orbit.multiplier:.3f}  "
            f"after impact {mismatches[-1]:.1e}",
            flush=True,
        )
    for name, value in sorted(worst.items(), key=lambda item: item[1]):
        show(f"smallest margin in scales: {name}", value, ">= 0.04")
    show("outputs and rates after the impact, whole guard", max(mismatches), "<= 1e-9")
    show("multiplier", max(o.multiplier for o in orbits), "<= 0.82")
    speeds = [o.speed_m_s for o in orbits]
    show("speed of the orbit m/s", f"{min(speeds):.3f}-{max(speeds):.3f}", "0.5-0.9")


def _margins_of(run: Run):
    """The compiled margins of a run's spec: gait and samples in. [N, K]."""
    return eqx.filter_jit(lambda gait, u: margin_matrix(run.spec, run.robot, gait, u)[0])


def _mismatch(run: Run) -> float:
    """Largest output or output rate after the real impact over the guard (rad, rad/s)."""
    zd = run.zero_dynamics

    @jax.jit
    @jax.vmap
    def eta(level):
        impact = zd.point(run.gait.z(jnp.stack([jnp.ones_like(level), level]))).impact
        return zd.phi(jnp.concatenate([impact.q, impact.dq]))[0]

    return float(jnp.max(jnp.abs(eta(jnp.linspace(0.0, 1.0, 1001)))))


if __name__ == "__main__":
    main()
