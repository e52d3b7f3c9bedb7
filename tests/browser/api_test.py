#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calls each path and method of docs/reference/page_openapi.yaml and checks the answers against its schemas; a wrong
method is answered with the right ones.

usage: api_test.py MIXRIG
Exit status 77: skipped, selenium is not there (rig.py).
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.error
import urllib.parse
import urllib.request

import yaml

from rig import Rig, comes_true

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs/reference"
TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}
METHODS = ("get", "put", "post", "delete")
CENTRE = [0.5, 0.75]


def resolved(spec, schema):
    while "$ref" in schema:
        node = spec
        for part in schema["$ref"].removeprefix("#/").split("/"):
            node = node[part]
        schema = node
    return schema


def check(spec, schema, value, where):
    """A key that the schema does not name is wrong, too: the text is the whole of it."""
    schema = resolved(spec, schema)
    if value is None:
        assert schema.get("nullable"), f"{where}: null"
        return
    for one in schema.get("allOf", []):
        check(spec, one, value, where)
    if "type" not in schema:
        return
    kind = schema["type"]
    assert isinstance(value, TYPES[kind]) and (kind == "boolean" or not isinstance(value, bool)), f"{where}: {value!r} is no {kind}"
    assert value in schema.get("enum", [value]), f"{where}: {value!r}"
    if kind in ("integer", "number"):
        assert schema.get("minimum", value) <= value <= schema.get("maximum", value), f"{where}: {value}"
    if kind == "array":
        assert schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)), f"{where}: {value}"
        for i, item in enumerate(value):
            check(spec, schema.get("items", {}), item, f"{where}[{i}]")
    if kind == "object" and "properties" in schema:
        assert set(value) <= set(schema["properties"]), f"{where}: not described: {set(value) - set(schema['properties'])}"
        for key, item in value.items():
            check(spec, schema["properties"][key], item, f"{where}.{key}")


class Api:
    def __init__(self, rig):
        self.rig, self.url, self.called = rig, rig.url + "api/v1", set()
        with urllib.request.urlopen(rig.url + "page_openapi.yaml", timeout=30) as answer:
            text = answer.read().decode()
        assert text == (DOCS / "page_openapi.yaml").read_text(), "the served text is another one"
        self.spec = yaml.safe_load(text)

    def send(self, method, path, body=None, kind="application/json"):
        data = None if method == "get" else body if isinstance(body, bytes) else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.url + urllib.parse.quote(path), data, {"Content-Type": kind} if data else {},
                                         method=method.upper())
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                mjpeg = "multipart" in answer.headers["Content-Type"]
                return answer.status, answer.headers, answer.read(100) if mjpeg else answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()
        except TimeoutError as error:
            raise AssertionError(f"{method} {path}: no answer in 60 s") from error

    def call(self, method, path, body=None, status=200, kind="application/json", **values):
        """The answer, which must be one that the text describes."""
        operation = self.spec["paths"][path][method]
        self.called.add((method, path))
        target = re.sub(r"{(\w+)}", lambda found: str(values[found[1]]), path)
        code, headers, text = self.send(method, target, body, kind)
        assert code == status, f"{method} {target}: {code} {text[:300]}"
        answer = resolved(self.spec, operation["responses"].get(str(code), {"missing": code}))
        assert "missing" not in answer, f"{method} {target}: {code} is not described"
        if code >= 400:
            line = json.loads(text)["error"]
            assert line and "\n" not in line, line
            return line
        content = answer.get("content", {})
        if content:
            assert headers["Content-Type"].split(";")[0] in content, f"{target}: {headers['Content-Type']}"
        if headers["Content-Type"] != "application/json":
            return text
        value = json.loads(text)
        check(self.spec, content.get("application/json", {}).get("schema", {}), value, target)
        return value

    def part(self, name):
        value = self.call("get", "/{part}", part=name)
        check(self.spec, self.spec["components"]["schemas"]["State"]["properties"][name], value, name)
        return value


def reads(api):
    state = api.call("get", "/state")
    parts = api.spec["components"]["schemas"]["State"]["properties"]
    assert set(state) == set(parts), set(state) ^ set(parts)
    named = api.spec["paths"]["/{part}"]["get"]["parameters"][0]["schema"]["enum"]
    assert set(named) == set(parts), set(named) ^ set(parts)
    for name in parts:
        api.part(name)
    for view in api.spec["components"]["schemas"]["View"]["enum"]:
        assert api.call("get", "/picture/{view}.jpg", view=view)[:2] == b"\xff\xd8", view
    assert api.call("get", "/picture/{view}.mjpeg", view="key")
    assert "WebSocket" in api.call("get", "/picture/{view}.webrtc", status=426, view="key")
    assert "WebSocket" in api.call("get", "/event/websocket", status=426)
    api.call("get", "/focus")


def edits(api):
    name = api.part("objects")[0]["name"]
    api.call("put", "/view", {"view": "key"})
    api.call("put", "/freeze", {"on": True})
    api.call("put", "/freeze", {"on": False})
    api.call("put", "/objects/{name}", {"turn_deg": 30, "scale": 1.5}, name=name)
    assert api.part("objects")[0]["turn_deg"] == 30
    api.call("put", "/objects/{name}", {"turn_deg": 1}, status=404, name="nobody")
    api.call("post", "/objects/{name}/copy", name=name)
    model = (api.rig.folder / f"take/models/{name}.glb").read_bytes()
    api.call("post", "/objects/{name}", model, kind="model/gltf-binary", name="second")
    api.call("post", "/objects/{name}", b"none", status=422, kind="model/gltf-binary", name="third")
    api.call("delete", "/objects/{name}", name="second")
    api.call("post", "/scene/undo")
    api.call("post", "/scene/redo")
    api.call("post", "/scene/redo", status=409)
    api.call("post", "/lamps", {"name": "test", "position_m": [1, 1, 2], "intensity": [1, 1, 1]})
    api.call("put", "/lamps/{name}", {"intensity": [2, 2, 1.6]}, name="test")
    api.call("delete", "/lamps/{name}", name="test")
    api.call("put", "/objects/{name}", {"turn_deg": 60, "preview": True}, name=name)
    api.call("post", "/scene/discard")
    api.call("post", "/scene/save")
    api.call("put", "/focus", {"on": True, "distance_m": 3})
    api.call("put", "/focus", {"on": False})
    api.call("put", "/presets/{file}", {}, file="night")
    api.call("put", "/presets/{file}", {}, status=400, file="night")
    api.call("post", "/presets/{file}/recall", file="night")
    api.call("delete", "/presets/{file}", file="night")
    api.call("delete", "/presets/{file}", status=404, file="night")


def records(api):
    api.call("post", "/record/stop", status=409)
    api.call("post", "/record/start", {"name": "one", "notes": "rain"})
    api.call("post", "/record/start", {"name": "two"}, status=409)
    comes_true("frames", lambda: api.part("recording")["frames"] >= 5)
    api.call("post", "/record/stop")
    comes_true("a take", lambda: api.part("takes"))
    api.call("put", "/takes/{file}", {"circled": True, "notes": "wind"}, file="one")
    api.call("put", "/takes/{file}", {"circled": True}, status=404, file="no")
    take = comes_true("the circle", lambda: next(t for t in api.part("takes") if t["circled"]))
    for frame in (1, take["frames"], 2):
        assert api.call("get", "/takes/{file}/{frame}.jpg", file="one", frame=frame)[:2] == b"\xff\xd8", frame
    line = api.call("get", "/takes/{file}/{frame}.jpg", status=404, file="one", frame=take["frames"] + 1)
    assert f"1 to {take['frames']}" in line, line
    api.call("get", "/takes/{file}/{frame}.jpg", status=404, file="no", frame=1)


def asks_of_the_room(api):
    """A recording is played: no camera is set, no head turns."""
    api.call("put", "/cameras/{name}", {"gain": 2}, status=409, name="target")
    api.call("post", "/sweep/start", {}, status=409)
    api.call("post", "/sweep/cancel", status=409)
    for verb, possible in (("learn", "background"), ("scan", "scan")):
        api.call("post", f"/background/{verb}", status=200 if api.part(possible)["possible"] else 409)
    api.call("post", "/background/cancel", status=200 if api.part("scan")["total"] else 409)


def refuses_wrong_methods(api):
    """The methods of a path are those of the text, in Allow."""
    sample = {"part": "run", "view": "key", "name": "x", "file": "x", "frame": 1}
    for path, item in api.spec["paths"].items():
        target = re.sub(r"{(\w+)}", lambda found: str(sample[found[1]]), path)
        right = {method.upper() for method in METHODS if method in item}
        if target in ("/view", "/freeze", "/focus", "/lamps"):
            right.add("GET")  # a part of the state
        for method in sorted({"get", "put", "post", "delete", "patch"} - {one.lower() for one in right}):
            code, headers, text = api.send(method, target)
            if code == 404 and method == "get" and path == "/lamps/{name}":
                continue
            assert code == 405, f"{method} {target}: {code} {text}"
            assert set(headers["Allow"].split(", ")) == right, f"{method} {target}: {headers['Allow']}, not {right}"


def runs_the_examples(api):
    """The lines of the shell in page_api.md, on this address, and the buttons of Companion."""
    text = (DOCS / "page_api.md").read_text()
    block = re.search(r"```sh\n(.*?)```", text, re.S)[1]
    (api.rig.folder / "tree.glb").write_bytes(next((api.rig.folder / "take/models").glob("*.glb")).read_bytes())
    for line in block.strip().splitlines():
        line = line.replace("http://127.0.0.1:8437", api.rig.url.rstrip("/"))
        done = subprocess.run(["bash", "-c", line], cwd=api.rig.folder, capture_output=True, text=True)
        assert done.returncode == 0 and "error" not in json.loads(done.stdout), f"{line}: {done.stdout} {done.stderr}"
    buttons = re.findall(r"\| `(POST|PUT) (/\S+)` \| `(\{.*\})` \|", text)
    assert len(buttons) == 3, buttons
    for method, path, body in buttons:
        if path == "/record/stop":
            comes_true("frames", lambda: api.part("recording")["frames"] >= 2)
        code, _, answer = api.send(method.lower(), path, json.loads(body))
        assert code == 200, f"{method} {path}: {code} {answer}"


def main():
    with tempfile.TemporaryDirectory(prefix="mixrig-api-") as folder:
        os.environ["HOME"] = folder
        rig = Rig(sys.argv[1], folder)
        try:
            api = Api(rig)
            comes_true("frames", lambda: rig.state()["picture"]["frames"] > 0)
            for step in (reads, edits, records, asks_of_the_room, refuses_wrong_methods, runs_the_examples):
                step(api)
                print(step.__name__)
            described = {(m, p) for p, item in api.spec["paths"].items() for m in METHODS if m in item}
            assert described == api.called, f"not called: {described - api.called}"
            print(f"{len(described)} methods of {len(api.spec['paths'])} paths")
            assert rig.stop() == 0, rig.text()
        finally:
            rig.process.kill()


main()
