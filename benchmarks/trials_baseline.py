"""The rival of a diagnosis in blind trials, under the name that `trials.py` knows."""

from sysid.trials.sparse_regression import sparse_names as sparse_names
