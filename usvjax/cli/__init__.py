"""The command line: `usvjax COMMAND ...`.

A user's mistake is one line on stderr and exit code 2; Ctrl-C is 130, SIGTERM 143. Each command's
module is imported only when that command is asked for.
"""

import contextlib
import importlib
import io
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial, wraps
from typing import Any

from usvjax.cli import process
from usvjax.devices import naming_the_platform
from usvjax.suggest import did_you_mean

EXIT_USAGE = 2
_LEAST_COLUMNS = 40


@dataclass(frozen=True)
class Command:
    """A command of `usvjax`.

    Attributes:
        help: one line.
        example: a call that works in a source checkout.
        module: where it lives.
        name: the function there, or a dictionary of functions for a command with subcommands.
        passes_on: whether everything after the first argument goes to another program.
    """

    help: str
    example: str
    module: str
    name: str
    passes_on: bool = False


COMMANDS = {
    "study": Command(
        "run a study from a TOML file, or continue one",
        "usvjax study studies/tan2022.toml",
        "usvjax.cli.study",
        "study",
    ),
    "init": Command(
        "write a commented study file to begin with",
        "usvjax init dwa --out my_dwa.toml",
        "usvjax.cli.init",
        "init",
    ),
    "check": Command(
        "say what a study would run, how long and how large",
        "usvjax check studies/tan2022.toml",
        "usvjax.cli.check",
        "check",
    ),
    "reproduce": Command(
        "regenerate a paper's tables and figures beside the published values",
        "usvjax reproduce tan2022",
        "usvjax.cli.reproduce",
        "reproduce",
        passes_on=True,
    ),
    "plot": Command(
        "draw the figures of a run", "usvjax plot runs/tan2022", "usvjax.cli.plot", "plot"
    ),
    "animate": Command(
        "animate one episode of a run",
        "usvjax animate runs/tan2022 --job 3",
        "usvjax.cli.animate",
        "animate",
    ),
    "export": Command(
        "write where the vessels of one episode were, as CSV",
        "usvjax export runs/tan2022 --job 3",
        "usvjax.cli.export",
        "export",
    ),
    "route": Command(
        "find a route between two places on a map",
        "usvjax route hongze-250 --from 289,320 --to 45,88 --plot route.png",
        "usvjax.cli.route",
        "route",
    ),
    "maps": Command(
        "list, show, convert and draw maps",
        "usvjax maps show hongze-250",
        "usvjax.cli.maps",
        "MAPS_COMMANDS",
    ),
}


def main(args: Sequence[str] | None = None) -> int:
    """Run a command.

    Args:
        args: command and arguments; those of the process when None.

    Returns:
        The exit code. `--help` leaves through SystemExit instead.
    """
    given = list(sys.argv[1:] if args is None else args)
    return as_command(partial(_dispatch, given), whole=args is None)


def as_command(call: Callable[[], int], whole: bool) -> int:
    """Call what a command does, and turn what goes wrong into one line and an exit code.

    Args:
        call: does it, and returns the exit code.
        whole: whether the process ends with it.
    """
    with process.stopped_by_signals(to_the_end=whole):
        if whole:
            process.prepare()
        code = _answered(call)
    if whole and code > process.EXIT_SIGNAL:
        # Threads may be in the midst of episodes, which Python would wait for or trip over.
        os._exit(code)
    return code


def _answered(call: Callable[[], int]) -> int:
    from usvjax.cli.console import use_any_encoding
    from usvjax.errors import BadInputError, BadTypeError

    use_any_encoding()
    try:
        try:
            with naming_the_platform():
                return call()
        finally:
            process.flush()
    except (BadInputError, BadTypeError) as error:
        return _said(str(error), EXIT_USAGE)
    except KeyboardInterrupt as stop:
        return _said(str(stop) or "interrupted", process.exit_code())
    except BrokenPipeError:
        process.drop_output()  # whoever read it has left
        return process.EXIT_OUTPUT
    except Exception as error:
        if process.was_stopped():  # what a library has made of the interrupt
            return _said("interrupted", process.exit_code())
        if not isinstance(error, OSError) or not process.output_fails():
            raise
        process.drop_output()
        return _said(f"cannot write to standard output: {error.strerror}", process.EXIT_OUTPUT)


def _said(line: str, code: int) -> int:
    """The code, with a line on stderr, where that can be written."""
    from usvjax.cli.console import complain

    with contextlib.suppress(OSError):
        complain(f"usvjax: {line}")
        sys.stderr.flush()
    return code


def _dispatch(given: list[str]) -> int:
    if not given or given[0] in ("-h", "--help"):
        _print_help()
        return 0 if given else EXIT_USAGE
    if given[0] == "--version":
        import usvjax

        print(f"usvjax {usvjax.__version__}")
        return 0
    name, *rest = given
    if name not in COMMANDS:
        return _unknown(name)
    return _run(name, rest)


def _run(name: str, rest: list[str]) -> int:
    command = COMMANDS[name]
    target = getattr(importlib.import_module(command.module), command.name)
    if command.passes_on and rest and not rest[0].startswith("-"):
        return _exit_code(target(rest[0], *rest[1:]))
    return _exit_code(_parsed(target, f"usvjax {name}", rest)())


def _parsed(target: Any, prog: str, args: list[str]) -> Callable[[], Any]:
    """Read the arguments of a command, which is only run by what is returned.

    Raises:
        BadInputError: the arguments are not those of the command; one sentence.
    """
    import tyro

    if isinstance(target, dict):
        later = {name: _deferred(function) for name, function in target.items()}
        # What is wrong after the name of a subcommand is explained by that one's help.
        asked = f"{prog} {args[0]}" if args and args[0] in target else prog
        with usage_in_one_line(asked):
            call = tyro.extras.subcommand_cli_from_dict(later, prog=prog, args=args)
    else:
        with usage_in_one_line(prog):
            call = tyro.cli(_deferred(target), prog=prog, args=args)
    found: Callable[[], Any] = call
    return found


@contextlib.contextmanager
def usage_in_one_line(prog: str) -> Iterator[None]:
    """Turn what tyro prints about bad arguments, within, into one sentence.

    Args:
        prog: the command whose help explains them.

    Raises:
        BadInputError: with that sentence.
    """
    from usvjax.errors import BadInputError

    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said), _at_least_columns(_LEAST_COLUMNS):
            yield
    except SystemExit as stop:
        if stop.code != EXIT_USAGE:
            raise
        raise BadInputError(f"{_in_one_line(said.getvalue())} (see {prog} --help)") from None


@contextlib.contextmanager
def _at_least_columns(least: int) -> Iterator[None]:
    """Let tyro take a terminal for no narrower than this: it wraps by letters, or without end."""
    kept = os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = str(max(shutil.get_terminal_size().columns, least))
    try:
        yield
    finally:
        del os.environ["COLUMNS"]
        if kept is not None:
            os.environ["COLUMNS"] = kept


def _deferred(function: Callable[..., Any]) -> Callable[..., Callable[[], Any]]:
    """The function, called in two steps: with its arguments, and then to run."""

    @wraps(function)
    def later(*args: Any, **kwargs: Any) -> Callable[[], Any]:
        return partial(function, *args, **kwargs)

    return later


_NOT_A_NUMBER = re.compile(
    r"Error parsing (\S+): .*(?:int\(\) with base 10|(string to float)): (['\"].*['\"])"
)
"""What Python says of a number that is none, on its own or as the last of several attempts."""


def _in_one_line(box: str) -> str:
    """A message of the parser without its frame and its pointer to the help."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", box)
    unframed = re.sub(r"[\u2500-\u257f]|-{3,}|^[|+]|[|+]$", " ", plain, flags=re.MULTILINE)
    title, _, rest = unframed.strip(" \n-").partition("\n")
    words = " ".join(re.split("For full helptext|Argument helptext", rest)[0].split())
    number = _NOT_A_NUMBER.search(words)
    if number:
        option, any_number, got = number.groups()
        return f"{option}: got {got}; wanted a {'number' if any_number else 'whole number'}"
    sentence = re.sub(r" \.$", ".", words.replace(" (required)", ""))
    if sentence.lower().startswith(title.strip().lower()):
        return sentence
    return f"{title.strip()}: {sentence}"


def _exit_code(result: Any) -> int:
    return result if isinstance(result, int) else 0


def _unknown(name: str) -> int:
    from usvjax.cli.console import complain

    complain(f"usvjax: unknown command {name!r}; {did_you_mean(name, COMMANDS)}")
    return EXIT_USAGE


def _print_help() -> None:
    from usvjax.cli.console import show
    from usvjax.report.sheets import Sheet

    rows = [
        row
        for name, command in COMMANDS.items()
        for row in ((name, command.help), ("", command.example))
    ]
    show(
        "usage: usvjax COMMAND ...",
        "",
        "Massive-rollout simulator for unmanned surface vehicles.",
        "",
        Sheet("", (), rows, words=2),
        "usvjax COMMAND --help explains one command, usvjax --version says which version this is.",
    )
