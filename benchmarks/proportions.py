"""Shares and ratios with their uncertainty, as the study of blind trials has them."""

from sysid.trials.proportions import LEVEL as LEVEL
from sysid.trials.proportions import Share as Share
from sysid.trials.proportions import bootstrap as bootstrap
