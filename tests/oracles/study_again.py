"""The toy study whose runs are spoiled, run again, and what is said of them."""

import pytest
from study_fake import toy_study

from usvjax.errors import BadInputError
from usvjax.study import parse_spec, run_study

SPEC = parse_spec(toy_study(episodes=40, shard=20))


def again(run):
    return run_study(SPEC, run.parent)


def said_in_one_line(call, *arguments):
    """The message of a refusal."""
    with pytest.raises(BadInputError) as caught:
        call(*arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)
