"""`usvjax init`: a study file to begin with."""

from pathlib import Path
from typing import Annotated

import tyro

from usvjax.cli.console import show_line

Kind = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="KIND")]
PluginFile = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]
OutFile = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]
Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff]


def init(kind: Kind, out: OutFile = None, plugin: PluginFile = None, force: Flag = False) -> None:
    """Write a commented study file: every key, what it means, its unit, default and values.

    Example: usvjax init dwa --out my_dwa.toml

    Args:
        kind: What an episode is: dwa, route, cruise, fleet or aggregate, or the kind of a plugin.
        out: File to write; by default it is printed.
        plugin: A file of your own that brings the kind.
        force: Overwrite a file that is there.
    """
    from usvjax.errors import BadInputError
    from usvjax.registry import find_mission
    from usvjax.study.plugin import read_plugin
    from usvjax.study.template import template

    if plugin is not None:
        read_plugin(str(plugin), Path(), "usvjax init").load("usvjax init")
    name = None if plugin is None else _beside(plugin, out)
    text = template(kind, find_mission(kind, "usvjax init"), name)
    if out is None:
        print(text, end="")
        return
    if out.exists() and not force:
        raise BadInputError(f"{out} exists already; choose another --out, or give --force")
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadInputError(f"cannot write {out}: {error.strerror}") from error
    show_line(f"Study    {out}")


def _beside(plugin: Path, out: Path | None) -> str:
    """A plug-in's path as a study file in the place of `out` names it."""
    folder = Path() if out is None else out.parent
    path, base = plugin.resolve(), folder.resolve()
    return (path.relative_to(base) if path.is_relative_to(base) else path).as_posix()
