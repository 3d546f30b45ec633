"""Every key of the published schemas stands on docs/result-keys.md, and no other.

Of files without a schema the tests of their commands look (`tests/cli`).
"""

import json

import pytest

from sysid.cards.schema import json_schema as of_cards
from sysid.report.diagnosis_schema import json_schema as of_diagnoses
from tests.cards.example import example_card
from tests.structure.pages import DOCS, ROOT
from tests.structure.result_keys import PAGE, missing, published, told, written

SCHEMAS = {"card.json": of_cards, "diagnosis.json": of_diagnoses}


@pytest.mark.parametrize("file", SCHEMAS)
def test_the_page_has_the_keys_of_the_schema_and_no_others(file):
    declared = published(SCHEMAS[file]())
    assert len(declared) > 10
    assert missing(declared, file) == []
    assert told(file) == declared


def test_the_page_has_the_keys_of_a_committed_fit():
    for folder in sorted((ROOT / "fits").iterdir()):
        fit, card = (json.loads((folder / f"{z}.json").read_text()) for z in ("fit", "card"))
        assert missing(written(fit), "fit.json") == []
        assert missing(written(card), "card.json") == []


def test_a_key_that_is_not_explained_is_found():
    raw = json.loads(example_card().model_dump_json(by_alias=True))
    assert missing(written(raw), "card.json") == []
    raw["quality"]["new"] = raw["parameters"][0]["newer"] = 1.0
    assert missing(written(raw), "card.json") == ["parameters[].newer", "quality.new"]


def test_the_schemas_and_the_page_can_be_found():
    text = PAGE.read_text(encoding="utf-8")
    for name in ("cards/card-1.schema.json", "report/diagnosis-1.schema.json"):
        assert f"](../sysid/{name})" in text
    assert f"]({PAGE.name})" in (DOCS / "index.md").read_text(encoding="utf-8")
    assert f": {PAGE.name}" in (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
