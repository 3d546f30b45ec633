"""Which tests are held out, by globs on their ids."""

from collections.abc import Sequence
from fnmatch import fnmatchcase

import numpy as np
from jaxtyping import Bool

from sysid.data.heating import whole_test
from sysid.errors import DataError


def hold_out(ids: Sequence[str], globs: Sequence[str]) -> Bool[np.ndarray, " test"]:
    """True for each id that any glob matches (``*``, ``?``, ``[…]``; case matters).

    A glob that matches a test which was cut by temperature matches all parts of it.

    Args:
        ids: Ids of tests: the stem of the file, with ``#part`` where one file holds several, and
            ``@17.4C`` for a part at that temperature.
        globs: Patterns; each must match at least one id.

    Raises:
        DataError: A glob matches no test.
    """
    mask = np.zeros(len(ids), dtype=bool)
    for glob in globs:
        hit = np.array(
            [fnmatchcase(name, glob) or fnmatchcase(whole_test(name), glob) for name in ids],
            dtype=bool,
        )
        if not hit.any():
            known = ", ".join(list(ids)[:5]) + (", …" if len(ids) > 5 else "")
            raise DataError(
                f"the pattern {glob!r} matches none of the {len(ids)} tests",
                advice=f"Patterns are compared with whole test ids, e.g. {known}",
            )
        mask |= hit
    return mask
