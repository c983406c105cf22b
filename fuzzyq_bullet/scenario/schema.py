"""The JSON Schema of scenario files, for editors and validators."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import models_json_schema

from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER, planner_names, settings_for
from fuzzyq_bullet.scenario.expectations import expect_model
from fuzzyq_bullet.scenario.models import Scenario

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scenario file.

    ``planner`` accepts a registered name, or the settings of a registered planner; only those of
    the default planner may leave out the name. What takes geometry to see (``scenario.checks``) is
    not in it.
    """
    models = [(Scenario, "validation"), *((settings_for(n), "validation") for n in planner_names())]
    places, together = models_json_schema(models)  # type: ignore[arg-type]
    definitions = together["$defs"]
    choices: list[dict[str, Any]] = [
        {"type": "string", "enum": list(planner_names())},
        {"type": "null"},
    ]
    for name in planner_names():
        reference = places[(settings_for(name), "validation")]
        settings = definitions[reference["$ref"].rsplit("/", 1)[-1]]
        required = set(settings.get("required", ())) - {"name"}
        if name != DEFAULT_PLANNER:
            required.add("name")
        settings["required"] = sorted(required)
        choices.append(reference)
    scenario = definitions.pop("Scenario")
    planner = scenario["properties"]["planner"]
    scenario["properties"]["planner"] = {
        "title": "Planner",
        "description": planner.get("description", ""),
        "anyOf": choices,
    }
    definitions["Expect"] = expect_model().model_json_schema()
    definitions.pop("PlannerSettings", None)
    return {"$schema": DIALECT, **scenario, "title": "Scenario", "$defs": definitions}
