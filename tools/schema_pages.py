#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""schema_pages.py FOLDER: for each NAME.schema.json of the folder a page NAME.md beside it, with a row for each key: its path,
type, whether it is always there, and its description. README.md there gets links to them. tools/docs.sh runs it on a copy.

Python's standard library alone.
"""
import json
import pathlib
import re
import sys


def kind(schema):
    if "enum" in schema:
        return " ".join(f"`{value}`" if value is not None else "null" for value in schema["enum"])
    types = schema.get("type", "any")
    text = types if isinstance(types, str) else " or ".join(types)
    bounds = [f"≥ {schema['minimum']}" if "minimum" in schema else "", f"≤ {schema['maximum']}" if "maximum" in schema else ""]
    return " ".join([text] + [bound for bound in bounds if bound])


def rows(schema, root, path, seen):
    """(path, type, is always there, description) of every key below a schema; what refers to itself is followed once."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        if name in seen:
            return
        schema, seen = {**root["$defs"][name], **{k: v for k, v in schema.items() if k != "$ref"}}, seen | {name}
    required = set(schema.get("required", []))
    for key, below in schema.get("properties", {}).items():
        if key.startswith("$"):
            continue
        shown = root["$defs"][below["$ref"].rsplit("/", 1)[-1]] if "$ref" in below else below
        below_path = f"{path}.{key}" if path else key
        yield below_path, kind(shown), key in required, below.get("description", shown.get("description", ""))
        yield from rows(below, root, below_path, seen)
    if isinstance(schema.get("items"), dict):
        yield from rows(schema["items"], root, path + "[]", seen)
    if isinstance(schema.get("additionalProperties"), dict):
        yield path + ".*", kind(schema["additionalProperties"]), False, schema["additionalProperties"].get("description", "")
        yield from rows(schema["additionalProperties"], root, path + ".*", seen)


def page(name, schema):
    lines = [f"# {schema.get('title', name)}", "", schema.get("description", ""), "",
             f"By [{name}.schema.json]({name}.schema.json). `[]` is an element of a list, `.*` any key.", "",
             "| key | type | always | meaning |", "| --- | --- | --- | --- |"]
    for path, types, always, text in rows(schema, schema, "", frozenset()):
        lines.append(f"| `{path}` | {types} | {'yes' if always else ''} | {text} |".replace("<", "&lt;"))
    return "\n".join(lines) + "\n"


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    names = sorted(path.name.removesuffix(".schema.json") for path in folder.glob("*.schema.json"))
    for name in names:
        schema = json.loads((folder / f"{name}.schema.json").read_text(encoding="utf-8"))
        (folder / f"{name}.md").write_text(page(name, schema), encoding="utf-8")
    index = folder / "README.md"
    text = re.sub(r"\(([a-z]+)\.schema\.json\)", r"(\1.md)", index.read_text(encoding="utf-8"))
    index.write_text(text, encoding="utf-8")
    return 0 if names else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
