"""Drake in place of MuJoCo: its multibody dynamics, contact and time stepping. Needs extra `drake`.

A robot file is read once, by MuJoCo; no motion or contact comes from MuJoCo.
"""

from importlib.util import find_spec

from neuralgaits.errors import InputError

if find_spec("pydrake") is None:
    raise InputError(
        "expected Drake for --simulator drake, found none: pip install 'neuralgaits[drake]'"
    )
