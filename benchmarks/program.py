"""Which program a result belongs to, under the name that studies outside of the package know."""

from sysid.trials.program import fingerprint as fingerprint
from sysid.trials.program import meaning as meaning
