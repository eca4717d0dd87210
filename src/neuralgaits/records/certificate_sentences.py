"""Statements of a certificate in words for a reader who does not know its terms."""

from collections.abc import Iterable, Mapping

from neuralgaits._digits import at_least
from neuralgaits.records.certified import CertificateRecord, Verdict
from neuralgaits.records.level_words import (
    DISTURBED_LEVEL,
    FOR_EVER,
    FULL_ORDER_LEVEL,
    HIGHEST,
    ON_TARGET,
    ORBIT_LEVEL,
    WALKING_SET_LEVEL,
    WORDS,
)

AS_STATED = (
    "This is what the proof file states. For this page the conditions were derived again from the "
    "run's files and are those of the proof, and its bounds were compared with values at a few "
    "hundred points. Only check-proof bounds every box again."
)
"""What a page says of a proof that it has not checked box by box."""


def not_claimed(level: int | None) -> str:
    """List the effects that a proof up to this level does not cover, in plain words."""
    ticks = "control in ticks of a computer"
    if level == DISTURBED_LEVEL:
        ticks = "ticks of a computer that are further apart than is stated or miss a touchdown"
    return (
        f"{ticks}, delays, motors at their limits, ground that gives way as in MuJoCo, or the real "
        "machine"
    )


def assumptions(level: int, robots: str | None = None) -> tuple[str, ...]:
    """Return the assumptions of a proof up to this level, in plain words.

    Args:
        level: proved level.
        robots: box of robots that it is about, in words; None for the robot of the file.
    """
    one_robot = "masses and lengths are those of the robot file"
    robot = one_robot
    if robots is not None and robots.startswith("lean="):
        robot = (
            f"{one_robot}, but for the torso's centre of mass, which is up to "
            f"{robots.partition('=')[2]} from where the robot believes it at each touchdown"
        )
    elif robots is not None:
        robot = (
            f"lengths are those of the robot file, and what the box {robots} names is within it of "
            "the file's, the same in both legs"
        )
    rigid = (
        "links are rigid; the foot on the ground neither slips, rolls nor tips; an impact is "
        "sudden and without bounce; the ground is where the gait expects it, or no further off "
        f"than is stated; {robot}; the gait's numbers are those stored in the run"
    )
    exact = "joints are exactly where the gait wants them"
    if level < WALKING_SET_LEVEL:
        return rigid, exact
    following = f"{exact}, and are so again after each impact"
    if level < FULL_ORDER_LEVEL:
        return rigid, following
    sentences = (
        rigid,
        f"at levels 1 to 3: {following}",
        f"at level {FULL_ORDER_LEVEL}: motors do without delay exactly what the controller asks "
        "(exact input-output linearisation in continuous time)",
    )
    if level == FULL_ORDER_LEVEL:
        return sentences
    bounded = (
        "the torques of the law that is stated (exact input-output linearisation or scheduled-pd), "
        "up to an error that moves the joints' accelerations by no more than the bound that is "
        "stated; or those torques, held between ticks no further apart than is stated, one of them "
        "at each touchdown unless a free clock is stated"
    )
    return (*sentences, f"at level {HIGHEST}: {bounded}")


def states(level: int, with_commands: bool, certificate: CertificateRecord | None = None) -> str:
    """Return the statement of a level about a gait, with its premise about the joints.

    Args:
        level: number of the level.
        with_commands: whether the gait takes commands.
        certificate: certificate with the box of robots and floors; None for the robot of the file.
    """
    statement = _without_premise(level, with_commands, certificate)
    return statement if level >= FULL_ORDER_LEVEL else f"{ON_TARGET}, {statement}"


def states_with_commands(levels: Iterable[int], *first: str) -> str:
    """Return statements of levels below 4 about a gait with commands, after their one premise.

    Args:
        levels: numbers of the levels.
        first: statements to put before those of the levels.
    """
    statements = *first, *(_without_premise(level, True) for level in levels)
    return f"{ON_TARGET}, {'; '.join(statements)}"


def _without_premise(
    level: int, with_commands: bool, certificate: CertificateRecord | None = None
) -> str:
    if level == ORBIT_LEVEL and not with_commands and certificate is not None:
        if "floor" in certificate.parameters:
            of_one, own = _compared_robots(certificate)
            return (
                f"any two trajectories{of_one} whose footholds lie equally high, step by step, "
                f"converge; where all lie as meant, to one periodic orbit{own}"
            )
        if certificate.robots:
            return "one periodic orbit attracts the whole walking set, of each robot its own"
    return WORDS[level].statement(with_commands=with_commands)


def _compared_robots(certificate: CertificateRecord) -> tuple[str, str]:
    """Say of which robots walks are compared, and which robots have the orbit."""
    return (" of one robot", ", of each robot its own") if certificate.robots else ("", "")


def proved(
    certificate: CertificateRecord, with_commands: bool, words: Mapping[str, str] | None = None
) -> str:
    """Describe the proof, level by level up to the highest; level 1 must be proved.

    Args:
        certificate: certificate with the proof.
        with_commands: whether the gait takes commands.
        words: what conditions state, by name, as the page has them elsewhere.
    """
    level, count = certificate.proved_level, len(certificate.conditions)
    meant = WORDS[level].meaning(with_commands=with_commands)
    uneven = "floor" in certificate.parameters and level == ORBIT_LEVEL and not with_commands
    if uneven:
        of_one, own = _compared_robots(certificate)
        meant = (
            f"{FOR_EVER}. Any two walks{of_one} whose footholds lie equally high, step by step, "
            "come nearer and nearer to each other; where all lie as meant, to one motion that "
            f"repeats{own}."
        )
    robots = ""
    if certificate.robots:
        own = ", each with a motion of its own" if level >= ORBIT_LEVEL and not uneven else ""
        robots = f", of every robot {certificate.all_robots}{own}"
    if certificate.ground:
        robots += f", on every floor with {certificate.ground}"
    more = ""
    if certificate.robots:
        # The search ends where the sign is known: see docs/proof_files.md.
        more = (
            " For so many robots the search ends as soon as something is to spare, and does not "
            "look for how much."
        )
    return (
        f"Proved, to level {level} of {HIGHEST}{robots}: {meant} Every one of the "
        f"{count} conditions was shown at every state of its region, rounding errors included, "
        f"with at least {_least(certificate)} of its typical size to spare"
        f"{_tightest(certificate, words or {})}.{more}"
    )


def not_proved(certificate: CertificateRecord) -> str:
    """Describe which conditions are refuted, and which are undecided."""
    reasons, count = [], len(certificate.conditions)
    words_of: tuple[tuple[Verdict, str], ...] = (
        ("refuted", "broken at a state that was found"),
        ("undecided", "undecided"),
    )
    for verdict, say in words_of:
        if names := certificate.named(verdict):
            reasons.append(f"{len(names)} of {count} conditions {say} ({', '.join(names)})")
    return "; ".join(reasons) + "." if reasons else "No condition could be read."


def left_open(level: int, robots: str | None = None) -> str:
    """Return a sentence with the assumptions of a proof up to this level; see `assumptions`."""
    return f"The proof assumes that {'; '.join(assumptions(level, robots))}."


def _tightest(certificate: CertificateRecord, words: Mapping[str, str]) -> str:
    """Return which condition has the smallest margin, in brackets; empty without margins."""
    margins = {
        name: one.margin for name, one in certificate.conditions.items() if one.margin is not None
    }
    if not margins:
        return ""
    name = min(margins, key=lambda name: margins[name])
    said = words.get(name, "").partition(";")[0]
    return f" (tightest: {said + ', ' if said else ''}{name})"


def _least(certificate: CertificateRecord) -> str:
    least = certificate.least_margin
    return "–" if least is None else f"{at_least(100.0 * least, 2)} %"
