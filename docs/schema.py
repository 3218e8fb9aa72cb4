"""Write the JSON Schemas of the files that people write: ``python docs/schema.py``."""

import json
from pathlib import Path

from scenarios import Scenario
from suite.experiment.file import ExperimentFile

MODELS = {"experiment": ExperimentFile, "scenario": Scenario}


def schema_text(name: str) -> str:
    """The text of ``docs/NAME.schema.json``."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema"} | MODELS[name].model_json_schema()
    return json.dumps(schema, indent=1) + "\n"


if __name__ == "__main__":
    for each in MODELS:
        Path(__file__).with_name(f"{each}.schema.json").write_text(schema_text(each), encoding="utf-8")
