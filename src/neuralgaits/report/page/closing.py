"""The end of the page: what failed, what is missing, how to make it again, what words mean."""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from neuralgaits.report.figure import Drawn, Missing
from neuralgaits.report.page import words
from neuralgaits.report.page.markup import (
    Html,
    command,
    facts,
    items,
    join,
    number,
    paragraph,
    scrolling,
    section,
    shell,
    table,
    tag,
)
from neuralgaits.report.page.saved import Contents, Saved
from neuralgaits.robots import registry


def failures(contents: Contents) -> Html:
    """Everything that did not work, with its reason."""
    found = list(_failures(contents))
    if found:
        return section("failures", "What failed, and why", items(found))
    said = "Nothing failed in what was done with this run. What was not done is listed next."
    return section("failures", "What failed, and why", paragraph(said))


def _failures(contents: Contents) -> Iterator[str]:
    saved = contents.saved
    for file, reason in saved.damaged.items():
        yield f"{file}: {reason}"
    measured = (saved.summary or {}).get("conditions") or {}
    for name, entry in measured.items():
        if entry["max_violation"] > 0.0:
            most = number(entry["max_violation"])
            yield f"Training left {name} violated on samples, by up to {most} in its own unit."
    for name, entry in ((saved.certificate or {}).get("conditions") or {}).items():
        point = entry["counterexample"]
        if point is not None:
            z1, z2 = (number(value, 6) for value in point["z"])
            yield (
                f"{name} is refuted: at z1 = {z1} m, z2 = {z2} kg m²/s its margin is "
                f"{number(point['margin'])} of its scale."
            )
        elif entry["verdict"] == "undecided":
            share = number(100.0 * entry["proved_fraction"])
            yield f"{name} is undecided: {share} % of its region is proved."
    for entry in (saved.certificate or {}).get("levels") or ():
        if entry["verdict"] != "proved":
            yield f"Level {entry['level']} is {entry['verdict']}: {entry['reason']}."
    yield from _falls(contents)
    if saved.episodes and saved.episodes.get("diverged"):
        yield f"Training diverged in a round of the episodes: {saved.episodes['diverged']}"


def _falls(contents: Contents) -> Iterator[str]:
    done, walks = contents.saved.simulation, contents.saved.walks
    for where, found in (("In simulation", done), ("In its round of episodes", walks)):
        reasons = Counter(reason for reason in (found or {}).get("fall_reasons", ()) if reason)
        for reason, count in reasons.items():
            yield f"{where} {count} of {len((found or {})['fall_reasons'])} walks fell: {reason}."
    shown = contents.walk
    if shown is not None and shown["fell"]:
        steps, why = shown["steps_walked"], shown["fall_reason"]
        yield f"The walk shown above fell after {steps} steps: {why}."


def missing(contents: Contents) -> Html:
    """What this run does not have yet, and the command that makes it."""
    by_command: dict[str, list[str]] = {}
    for what, line in missing_parts(contents):
        by_command.setdefault(line, []).append(what)
    rows = [("; ".join(what), tag("code", line)) for line, what in by_command.items()]
    if not rows:
        return section("missing", "What is missing", paragraph("Nothing: every part is here."))
    head = ("missing", "the command that makes it")
    return section("missing", "What is missing", table("Parts this run does not have", head, rows))


def missing_parts(contents: Contents) -> Iterator[tuple[str, str]]:
    """What is not there, in words, and the command that makes it."""
    saved = contents.saved
    if saved.summary is None:
        again = command("neuralgaits", "train", saved.robot, "--resume", saved.name)
        yield "the end of the training", again
        return
    if saved.simulation is None:
        yield "simulations", command("neuralgaits", "simulate", saved.name)
    if saved.certificate is None:
        if not saved.config.get("not_provable_because"):
            yield "a certificate", command("neuralgaits", "certify", saved.name)
    elif (level := saved.certificate["level"]) < words.LAST_LEVEL:
        line = command("neuralgaits", "certify", saved.name, "--level", level + 1)
        yield f"level {level + 1}: {words.LEVELS[level + 1]}", line
    for figure in contents.figures:
        if isinstance(figure, Missing):
            yield f"figure “{figure.title}”: {figure.reason}", figure.command


def reproduction(contents: Contents) -> Html:
    """Commands, versions and hashes."""
    saved = contents.saved
    config = saved.config
    lines = [_training(saved)]
    if saved.certificate is not None:
        line: list[Any] = [
            "neuralgaits",
            "certify",
            saved.name,
            "--level",
            saved.certificate["level"],
        ]
        if saved.disturbance:
            line += ["--disturbance", ",".join(repr(bound) for bound in saved.disturbance)]
        lines.append(command(*line))
    if saved.simulation is not None:
        lines.append(_simulation(saved.name, saved.simulation))
    lines.append(command("neuralgaits", "report", saved.name))
    versions = list((config.get("written_by") or {}).items())
    hashes = [(tag("code", file), tag("code", digest)) for file, digest in saved.hashes.items()]
    return section(
        "reproduce",
        "How to make it again",
        paragraph(
            "On the same machine and the same versions these commands give the same weights, bit "
            "for bit; elsewhere, a gait that differs in its last digits. Remove the run, or train "
            "into another folder, first."
        ),
        shell(lines),
        facts(f"Versions, {config.get('created_utc', '')}", versions),
        table("Files of the run", ("file", "sha256"), hashes),
    )


def _training(saved: Saved) -> str:
    config = saved.config
    if config.get("parent"):
        line = ["neuralgaits", "refine", config["parent"], "--seed", config["seed"]]
        line += ["--residual", f"{saved.name}/residual.safetensors", "--steps", config["steps"]]
        bounds = config.get("disturbance")
        if bounds and any(bounds):
            line += ["--disturbance", ",".join(repr(bound) for bound in bounds)]
        return command(*line, *_proof_asked(config), "--out", saved.name)
    known = config.get("robot") in registry.built_in()
    line = ["neuralgaits", "train", config["robot"] if known else f"{saved.name}/robot.xml"]
    spec = str(config.get("spec"))
    own = ".py:" in spec
    line += ["--spec", f"{saved.name}/spec.py:{spec.rpartition(':')[2]}" if own else spec]
    line += ["--seed", config["seed"], "--init", config["init"], "--steps", config["steps"]]
    if config.get("hidden"):
        line += ["--hidden", ",".join(str(width) for width in config["hidden"])]
    return command(*line, *_proof_asked(config), "--out", saved.name)


def _proof_asked(config: Mapping[str, Any]) -> list[Any]:
    asked = config.get("certify")
    if asked is None:
        return []
    budget = asked.get("budget_s")
    return ["--certify", *([] if budget is None else ["--budget", budget])]


def _simulation(name: str, done: Mapping[str, Any]) -> str:
    line = ["neuralgaits", "simulate", name, "--plant", done["plant"]]
    line += ["--controller", done["controller"], "--steps", done.get("steps", 50)]
    line += ["--start", done["start"], "--seed", done["seed"], "--episodes", done["episodes"]]
    if done.get("push"):
        line += ["--push", done["push"]]
    if changed := words.disturbances(done.get("disturb")):
        line += ["--disturb", ",".join(f"{name}={value!r}" for name, value in changed.items())]
    return command(*line)


def figures(contents: Contents, pictures: Mapping[str, Html]) -> Html:
    """Every figure with its caption, or why it is not there.

    Args:
        contents: of the page.
        pictures: an image element for each drawn figure, by name.
    """
    parts = []
    for figure in contents.figures:
        if isinstance(figure, Drawn):
            caption = tag("figcaption", tag("b", f"{figure.title}. "), figure.caption)
            picture = scrolling(figure.title, pictures[figure.name])
            parts.append(tag("figure", picture, caption))
    absent = [figure.title for figure in contents.figures if isinstance(figure, Missing)]
    if absent:
        told = f"Not drawn, because what they show is not there: {'; '.join(absent)}. "
        link = tag("a", "What is missing", href="#missing")
        parts.append(paragraph(told, link, " has the commands.", class_="quiet"))
    if not parts:
        parts.append(paragraph("There are no figures of this run."))
    return section("figures", "Figures", *parts)


def glossary() -> Html:
    """Ten words."""
    entries = join(join([tag("dt", term), tag("dd", meaning)]) for term, meaning in words.GLOSSARY)
    return section("words", "Ten words", tag("dl", entries))
