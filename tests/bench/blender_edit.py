# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes an edit that quality_bench has written with Blender's Laplacian Deform modifier; writes JSON.

usage: blender -b --factory-startup -noaudio --python-exit-code 1 --python blender_edit.py -- SCENE OUTPUT
"""
import array
import json
import pathlib
import statistics
import sys
import time

import bpy
from mathutils import Matrix

MOVES = 5  # updates timed, with the modifier and without
GROUP = "constrained"


def make_object(vertices, faces):
    mesh = bpy.data.meshes.new("scene")
    count = len(faces) // 3
    mesh.vertices.add(len(vertices) // 3)
    mesh.vertices.foreach_set("co", vertices)
    mesh.loops.add(len(faces))
    mesh.loops.foreach_set("vertex_index", faces)
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", range(0, 3 * count, 3))
    mesh.polygons.foreach_set("loop_total", [3] * count)
    mesh.update(calc_edges=True)
    thing = bpy.data.objects.new("scene", mesh)
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    return thing


def evaluated(thing):
    """Positions after all modifiers, flat."""
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    positions = array.array("f", bytes(12 * len(mesh.vertices)))
    mesh.vertices.foreach_get("co", positions)
    return positions


def update_ms(hooks, maps, fraction):
    """Milliseconds from hooks moved nearly where they have to go, to the evaluated mesh."""
    start = time.perf_counter()
    for hook, rows in zip(hooks, maps):
        near = Matrix(rows + [[0, 0, 0, 1]])
        near.translation *= fraction
        hook.matrix_world = near
    bpy.context.view_layer.update()
    return 1e3 * (time.perf_counter() - start)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    scene = json.loads(pathlib.Path(arguments[0]).read_text(encoding="utf-8"))
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    thing = make_object(array.array("d", scene["vertices"]), array.array("i", scene["faces"]))
    held, hooks = list(scene["anchors"]), []
    for group in scene["groups"]:
        hook = bpy.data.objects.new("hook", None)
        bpy.context.collection.objects.link(hook)
        hooks.append(hook)
        bpy.context.view_layer.update()
        mover = thing.modifiers.new("move", "HOOK")
        mover.object = hook
        mover.vertex_indices_set(group["vertices"])
        held += group["vertices"]
    thing.vertex_groups.new(name=GROUP).add(held, 1.0, "REPLACE")
    modifier = thing.modifiers.new("laplacian", "LAPLACIANDEFORM")
    modifier.vertex_group = GROUP
    maps = [group["map"] for group in scene["groups"]]

    def updates():
        return statistics.median(update_ms(hooks, maps, 1 - 0.002 * k) for k in range(MOVES, -1, -1))

    modifier.show_viewport = False
    base_ms = updates()
    for hook in hooks:
        hook.matrix_world = Matrix()
    modifier.show_viewport = True
    bpy.context.view_layer.update()
    start = time.perf_counter()
    bpy.ops.object.laplaciandeform_bind(modifier=modifier.name)
    bpy.context.view_layer.update()
    bind_ms = 1e3 * (time.perf_counter() - start)
    if not modifier.is_bind:
        sys.exit("blender_edit.py: the modifier could not be bound")
    moved_ms = updates()
    pathlib.Path(arguments[1]).write_text(json.dumps({
        "positions": list(evaluated(thing)),
        "bind_ms": bind_ms,
        "update_ms": max(moved_ms - base_ms, 0)
    }), encoding="utf-8")


main()
