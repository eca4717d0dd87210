"""Models of other robots, with all hashes made anew: a proof of what is printed, or none."""

from collections.abc import Callable

from support.forgeries.base import LOOSE, NO, UNREADABLE, Answer, Case, Table, Theme, refused, true
from support.forgeries.edits import NOBODY

THEME = Theme("small")
INVALID = refused("unreadable rejected")


def _hashes(table: Table) -> None:
    """Of files that nobody has."""
    table["robot"]["sha256"] = table["spec"]["sha256"] = table["weights_sha256"] = NOBODY


def _kind(what: str, change: Callable[[Table], None], cpp: Answer, *, anew: bool = True) -> None:
    @THEME.forgery(what, cpp=cpp, alone=LOOSE)
    def _(case: Case) -> None:
        change(case.table["model"]["robot"])
        if anew:
            _hashes(case.table)


def _torso(name: str, value: float) -> Callable[[Table], None]:
    def change(robot: Table) -> None:
        robot["torso"][name] = value.hex()

    return change


def _leg(name: str, value: float) -> Callable[[Table], None]:
    def change(robot: Table) -> None:
        robot["leg"][1][name] = value.hex()

    return change


def _whole(name: str, value: object) -> Callable[[Table], None]:
    def change(robot: Table) -> None:
        robot[name] = value.hex() if isinstance(value, float) else value

    return change


_kind("the torso's mass", _torso("mass", 13.25), true(r"\b13\.25\b"))
_kind("the torso's centre of mass", _torso("along", 0.21875), true(r"\b0\.21875\b"))
_kind("the torso's centre of mass, across", _torso("across", 0.015625), true(r"\b0\.015625\b"))
_kind("the torso's inertia", _torso("inertia", 0.1875), true(r"\b0\.1875\b"))
_kind("the thigh's mass", _leg("mass", 3.5), true(r"\b3\.5\b"))
_kind("the thigh's length", _leg("length", 0.40625), true(r"\b0\.40625\b"))
_kind("the thigh's rotor inertia doubled", _leg("armature", 0.875), true(r"\b0\.875\b"))
_kind("damping", _leg("damping", 0.125), true(r"\b0\.125\b"))
_kind("the torque limit 1e6", _leg("torque_limit", 1e6), true(r"\b(1e\+?0?6|1000000)\b"))
_kind("the joint range", _leg("upper", 1.375), true(r"\b1\.375\b"))
_kind("the joint range, lower end", _leg("lower", -1.375), true(r"-1\.375\b"))
_kind("gravity", _whole("gravity", 9.75), true(r"\b9\.75\b"))
_kind("friction 5", _whole("friction", 5.0), true(r"friction\D{0,20}5\b"))
_kind("foot radius", _whole("foot_radius", 0.0625), true(r"\b0\.0625\b"))
_kind("the model's robot called atlas", _whole("name", "atlas"), true(r"\batlas\b"))
_kind(
    "the torque limit 1e6 under the true hashes",
    _leg("torque_limit", 1e6),
    true(r"\b(1e\+?0?6|1000000)\b"),
    anew=False,
)

_kind("friction 'banana'", _whole("friction", "banana"), INVALID)
_kind("friction in decimals", _whole("friction", 0), INVALID)
_kind("friction that is not a number", _whole("friction", "nan"), INVALID)
_kind("friction negative", _whole("friction", -0.5), NO)
_kind("no friction", lambda robot: robot.pop("friction"), INVALID)
_kind("foot radius 'big'", _whole("foot_radius", "big"), INVALID)
_kind("foot radius negative", _whole("foot_radius", -0.5), NO)
_kind("a joint range of words", lambda robot: robot["leg"][0].update(lower="any"), INVALID)
_kind("a joint range upside down", lambda robot: robot["leg"][0].update(lower="0x1p3"), NO)
_kind("a mass of nothing", _torso("mass", 0.0), INVALID)
_kind("a mass below nothing", _leg("mass", -1.0), INVALID)
_kind("a mass of 1e300 kg", _torso("mass", 1e300), NO)
_kind("a mass of 5e-324 kg", _torso("mass", 5e-324), true(r"e-324"))
_kind("a length of 1e300 m", _leg("length", 1e300), NO)
_kind(
    "a fraction of a last place more",
    lambda robot: robot.update(gravity="0x1.39eb851eb851f8p+3"),
    INVALID,
)
_kind("a name that is no text", _whole("name", 7), INVALID)
_kind("a torque limit of nothing", _leg("torque_limit", 0.0), INVALID)
_kind("a fourth link", lambda robot: robot["leg"].extend(2 * robot["leg"][:1]), INVALID)
_kind("no torso", lambda robot: robot.update(torso=None), INVALID)
_kind("a field that is not known", lambda robot: robot.update(note="trust me"), UNREADABLE)


@THEME.forgery("no model at all", cpp=refused("undecided"), alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    case.table["model"] = None


@THEME.forgery("a policy of another kind", cpp=NO, alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"]["policy"]["kind"] = "MLPPolicy"


@THEME.forgery("a policy of another activation", cpp=true(r"softplus"), alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"]["policy"]["activation"] = "softplus"


@THEME.forgery("a policy that does not look at z2", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"]["policy"]["z2_dependence"] = False


@THEME.forgery("z1 at the guard elsewhere", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    arrays = case.table["model"]["policy"]["arrays"]
    arrays["z_guard"] = {"shape": [], "values": [(0.1875).hex()]}


@THEME.forgery("fences in another unit", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    arrays = case.table["model"]["tube"]
    arrays["unit"] = {"shape": [], "values": [(190.0).hex()]}


@THEME.forgery("the tube over another span", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"]["tube"]["span"] = {"shape": [2], "values": [(-0.01).hex(), (0.01).hex()]}


@THEME.forgery(
    "a user's condition of the name of the spec's", cpp=refused("undecided"), alone=LOOSE
)
def _(case: Case) -> None:
    case.table["model"]["conditions"]["tall"]["quantity"] = {"user": "mine.tall"}


@THEME.forgery(
    "a condition of the model that the Program has not",
    cpp=refused("rejected unreadable undecided"),
    alone=NO,
)
def _(case: Case) -> None:
    conditions = case.table["model"]["conditions"]
    conditions["safe"] = conditions["tall"]


@THEME.forgery("a condition's bound restated", cpp=true(r"above -10 m"), alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"]["conditions"]["tall"]["quantity"]["bound"] = -10.0


@THEME.forgery("a condition's bound as a list of one", cpp=LOOSE, alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"]["conditions"]["tall"]["quantity"]["bound"] = [0.5]


@THEME.forgery("a barrier restated as a pointwise condition", about="walk", alone=LOOSE)
def _(case: Case) -> None:
    condition = case.table["model"]["conditions"]["torso-lower"]
    condition["kind"] = "Pointwise"
    del condition["alpha"]


@THEME.forgery(
    "a barrier restated so that it holds of anything",
    about="walk",
    cpp=true(r"above -10 rad"),
    alone=LOOSE,
)
def _(case: Case) -> None:
    case.table["model"]["conditions"]["torso-lower"]["quantity"]["bound"] = -10.0
