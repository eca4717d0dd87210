"""Compare a deployment file that could be read with the run that it is about."""

from collections import Counter
from collections.abc import Iterator, Sequence

from neuralgaits._names import meant
from neuralgaits._printable import shown
from neuralgaits.deployment.deployed_robot import DeployedRobot, JointFacts
from neuralgaits.deployment.deployment_file import (
    ContactChannel,
    DeployedJoint,
    DeploymentFile,
)


def hash_problems(file: str, deployment: DeploymentFile, about: DeployedRobot) -> Iterator[str]:
    """Yield how files and period differ from the run's."""
    for name, one in (
        ("robot", deployment.robot),
        ("policy", deployment.policy),
        ("proof", deployment.proof),
    ):
        own = about.files[name]
        if one is None or one.sha256 == "":
            if one is None and own is not None:
                yield (
                    f"{file}: files.proof: expected sha256 {own.sha256} as of {about.run}, found "
                    "none: the run was proved since; export it again, or copy the hash"
                )
            continue
        if own is None:
            yield (
                f"{file}: files.{name}: expected null, since {about.run} has none, found sha256 "
                f"{one.sha256}: it is about another run; export that one"
            )
        elif one.sha256 != own.sha256:
            yield (
                f"{file}: files.{name}: expected sha256 {own.sha256} as of {about.run}, found "
                f"{one.sha256}: it is about another run; export that one, or copy the hash"
            )
    if deployment.period_s and abs(deployment.period_s - about.period_s) > 1e-9:
        yield (
            f"{file}: period_s: expected {about.period_s:g}, the tick that the controller is made "
            f"for, found {deployment.period_s:g}: write {about.period_s:g} and tick at that period"
        )


def joint_problems(
    file: str, joints: Sequence[DeployedJoint], about: DeployedRobot, *, whole: bool
) -> Iterator[str]:
    """Yield what is wrong with the joints.

    Args:
        file: name of the file.
        joints: joints that could be read.
        about: robot of the run.
        whole: whether all could be read, so that those that lack are missing.
    """
    facts = {one.name: one for one in about.joints}
    yield from _names(file, "joints", "joint", [one.joint for one in joints], list(facts), whole)
    yield from _twice(file, "motor", [(one.joint, one.motor) for one in joints])
    for one in joints:
        if one.joint in facts:
            yield from _numbers(file, one, facts[one.joint])


def contact_problems(
    file: str, contacts: Sequence[ContactChannel], about: DeployedRobot, *, whole: bool
) -> Iterator[str]:
    """Yield what is wrong with the contacts of the feet."""
    feet = [one.foot for one in contacts]
    yield from _names(file, "contacts", "foot", feet, list(about.feet), whole)
    yield from _twice(file, "channel", [(one.foot, one.channel) for one in contacts])
    for one in contacts:
        if one.newton_per_unit == 0.0:
            yield (
                f"{file}: {one.foot}: newton_per_unit: expected a number other than 0, found 0: of "
                "a switch, write a force above that of a touchdown"
            )


def _names(
    file: str, what: str, kind: str, names: list[str], expected: list[str], whole: bool
) -> Iterator[str]:
    missing = [name for name in expected if name not in names]
    for name, count in Counter(names).items():
        if name not in expected:
            hint = meant(name, missing) or f"write one of {', '.join(expected)}"
            missing = [one for one in missing if one not in hint]
            yield (
                f"{file}: {what}: expected a {kind} of the robot file, found {shown(name)}: {hint}"
            )
        elif count > 1:
            yield f"{file}: {what}: expected {name} once, found it {count} times: delete one"
    if whole and missing:
        yield (
            f"{file}: {what}: expected every {kind} of the robot file, found no "
            f"{', '.join(missing)}: add it"
        )


def _twice(file: str, what: str, named_lines: list[tuple[str, int]]) -> Iterator[str]:
    for index, count in Counter(number for _, number in named_lines).items():
        if count > 1:
            names = ", ".join(name for name, number in named_lines if number == index)
            yield (
                f"{file}: {what}: expected each index once, found {index} at {names}: give each "
                "its own"
            )


def _numbers(file: str, one: DeployedJoint, facts: JointFacts) -> Iterator[str]:
    at = f"{file}: {one.joint}"
    # Share by which a range or limit of the file may exceed the robot file's: rounding of a copy.
    rounding = 1e-6
    slack = rounding * (facts.upper_rad - facts.lower_rad)
    if not one.lower_rad < one.upper_rad:
        yield (
            f"{at}: lower_rad, upper_rad: expected lower_rad below upper_rad, found "
            f"{one.lower_rad:g} and {one.upper_rad:g}: exchange them"
        )
    elif one.lower_rad < facts.lower_rad - slack or one.upper_rad > facts.upper_rad + slack:
        yield (
            f"{at}: lower_rad, upper_rad: expected a range within the robot file's, "
            f"{facts.lower_rad:g} to {facts.upper_rad:g} rad, found {one.lower_rad:g} to "
            f"{one.upper_rad:g}: narrow it, or change the robot file and train again"
        )
    if one.torque_limit_nm > facts.torque_limit_nm * (1.0 + rounding):
        yield (
            f"{at}: torque_limit_nm: expected at most the robot file's {facts.torque_limit_nm:g} "
            f"N m, found {one.torque_limit_nm:g}: lower it, or change the robot file and train "
            "again"
        )
