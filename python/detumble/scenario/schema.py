"""The JSON Schema of a scenario file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic.json_schema import GenerateJsonSchema

from detumble.scenario.declarations import declarations

if TYPE_CHECKING:
    from detumble.scenario.section import Section


def schema_of(model: type[Section]) -> dict[str, Any]:
    """Describe the file: TOML knows no null, so optional keys are merely not required.

    Args:
        model: the scenario class.

    Returns:
        A JSON Schema (draft 2020-12); its key `x-core` says what the core makes of the fields.
    """
    schema = _without_null(model.model_json_schema())
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "x-core": declarations()}


def _without_null(node: Any) -> Any:
    if isinstance(node, list):
        return [_without_null(element) for element in node]
    if not isinstance(node, dict):
        return node
    node = {key: _without_null(value) for key, value in node.items() if not (key == "default" and value is None)}
    for name, value in node.get("properties", {}).items():
        if "const" in value and "default" in value:  # Python knows it by the class, a file by this key
            del value["default"]
            node["required"] = [*node.get("required", ()), name]
    choices = [choice for choice in node.get("anyOf", ()) if choice != {"type": "null"}]
    if len(choices) == 1:
        del node["anyOf"]
        return {**choices[0], **node}
    return node
