"""Model cards: the JSON file that simulators read.

Importing this package, and reading a card without its check, loads neither JAX nor SciPy.
"""

from sysid.cards.read import read_card
from sysid.cards.schema import Card
from sysid.cards.write import write_card

__all__ = ["Card", "read_card", "write_card"]
