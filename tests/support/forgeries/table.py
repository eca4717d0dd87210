"""All kinds, by theme."""

from support.forgeries import (
    characters,
    code,
    full_order,
    models,
    names,
    other_runs,
    parameters,
    programs,
    regions,
    run_files,
    summaries,
    texts,
    trees,
    unstated,
    walks,
)
from support.forgeries.base import Forgery

THEMES: dict[str, list[Forgery]] = {
    module.__name__.rpartition(".")[2]: module.THEME.kinds
    for module in (
        names,
        characters,
        regions,
        trees,
        programs,
        parameters,
        full_order,
        unstated,
        models,
        other_runs,
        code,
        texts,
        summaries,
        run_files,
        walks,
    )
}
KINDS = [kind for kinds in THEMES.values() for kind in kinds]
