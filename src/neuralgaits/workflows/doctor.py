"""Check of this machine: one finding each and, where something is wrong, one line that fixes it."""

import importlib.util
import os
import platform
import subprocess
import sys

from neuralgaits._compiler import Compiler
from neuralgaits._environment import OFF_SCREEN, why_jax_failed
from neuralgaits._version import __version__
from neuralgaits.records.installed import Finding, Machine

_RENDER = "from neuralgaits.simulation.video import trial; trial()"
"""Code that does the first part of `simulate --video`."""


def doctor() -> Machine:
    """Check the machine.

    Returns: a mapping of what `doctor --json` prints: `ok` (everything needed is available),
        `neuralgaits` (version) and python, device, x64, opengl, video, compiler, hzd, drake, onnx,
        mcap, deploy, gym, ray: {ok, needed, found, fix} each.
    """
    # Extras that only some verbs need: the module that each brings, its name, and its purpose.
    extras = {
        "video": ("imageio_ffmpeg", "imageio-ffmpeg", "videos"),
        "hzd": ("casadi", "CasADi", "`optimise`"),
        "drake": ("pydrake", "Drake", "`simulate --simulator drake`"),
        "onnx": ("onnxruntime", "ONNX Runtime", "`export --format onnx` and `vnnlib`"),
        "mcap": ("mcap", "MCAP", "logs in MCAP"),
        "deploy": ("yaml", "PyYAML", "deployment files"),
        "gym": ("gymnasium", "Gymnasium", "`neuralgaits.gym_env`"),
        "ray": ("ray", "Ray", "`--ray`"),
    }
    basic = (_python(), _device(), _double_precision(), _opengl())
    video, *others = (_extra(name, *about) for name, about in extras.items())
    findings = (*basic, video, _compiler(), *others)
    ready = all(finding.ok for finding in findings if finding.needed)
    return Machine(ready, __version__, *findings)


def _finding(ok: bool, state: str, fix: str, *, needed: bool = True) -> Finding:
    return Finding(ok, needed, state, None if ok else fix)


def _python() -> Finding:
    fix = "install Python 3.11 or newer and build the environment with it"
    return _finding(sys.version_info >= (3, 11), platform.python_version(), fix)


def _device() -> Finding:
    fix = "set JAX_PLATFORMS=cpu, or repair the accelerator's driver"
    try:
        import jax

        device = jax.devices()[0]
        description = f"{device.platform} ({device.device_kind}), {os.cpu_count()} cores, jax"
        return _finding(True, f"{description} {jax.__version__}", fix)
    except Exception as error:
        problem, _, remedy = (why_jax_failed(error) or f"{error}: {fix}").rpartition(": ")
        return _finding(False, " ".join(problem.split()), remedy)


def _double_precision() -> Finding:
    import jax

    on = bool(jax.config.read("jax_enable_x64"))
    fix = 'call jax.config.update("jax_enable_x64", True) first; the command line does'
    return _finding(on, "float64" if on else "float32 only", fix)


def _opengl() -> Finding:
    """Check whether pictures can be rendered; if not, suggest what would allow it."""
    setting = f"MUJOCO_GL={os.environ.get('MUJOCO_GL', 'default')}"
    if _renders():
        return _finding(True, f"{setting}: renders", "", needed=False)
    other = next((backend for backend in OFF_SCREEN if _renders(backend)), None)
    fix = (
        "for videos, install Mesa (libegl1 and libgl1 on Debian), then set MUJOCO_GL=egl"
        if other is None
        else f"for videos, set MUJOCO_GL={other}, which renders here"
    )
    return _finding(False, f"{setting}: no picture", fix, needed=False)


def _renders(backend: str | None = None) -> bool:
    """Try to render in a separate process, since a missing display can crash it."""
    environment = dict(os.environ) | ({} if backend is None else {"MUJOCO_GL": backend})
    try:
        trial = subprocess.run(
            [sys.executable, "-c", _RENDER],
            env=environment,
            capture_output=True,
            timeout=60.0,
        )
    except subprocess.TimeoutExpired:
        return False
    return trial.returncode == 0


def _extra(name: str, module: str, package: str, what: str) -> Finding:
    there = importlib.util.find_spec(module) is not None
    fix = f"for {what}, pip install 'neuralgaits[{name}]'"
    return _finding(there, f"{package} is {'' if there else 'not '}there", fix, needed=False)


def _compiler() -> Finding:
    compiler = Compiler.for_c()
    path = None if compiler is None else compiler.path
    fix = "for walks at MuJoCo's own speed, install gcc or clang, or what the extra `compiler` has"
    return _finding(path is not None, path or "no C compiler", fix, needed=False)
