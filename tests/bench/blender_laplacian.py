# SPDX-License-Identifier: GPL-3.0-or-later
"""Times Blender's Laplacian Deform modifier on a scene written by speed_bench --export; writes JSON.

usage: blender -b --factory-startup -noaudio --python-exit-code 1 --python blender_laplacian.py -- SCENE OUTPUT [MOVES]
"""
import array
import json
import math
import statistics
import sys
import time

import bpy

MOVES = 9  # updates timed, with the modifier and without
GROUP = "constrained"
BOUND = 0.5  # how far the handle may stay behind, of its way: Blender's constraints are soft


def read_scene(path):
    """@return vertices (flat), faces (flat), anchors, handle"""
    with open(path, "rb") as file:
        counts = array.array("i")
        counts.fromfile(file, 4)
        vertices, faces, anchors = array.array("d"), array.array("i"), array.array("i")
        vertices.fromfile(file, 3 * counts[0])
        faces.fromfile(file, 3 * counts[1])
        anchors.fromfile(file, counts[2])
    return vertices, faces, anchors, counts[3]


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


def handle_move(frame):
    """As in scene.cpp."""
    return (0.1 * math.sin(0.7 * frame + 0.3), 0.1 * math.cos(0.9 * frame), 0.25 + 0.1 * math.sin(0.31 * frame))


def evaluated(thing):
    """Positions after all modifiers, flat."""
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    positions = array.array("f", bytes(12 * len(mesh.vertices)))
    mesh.vertices.foreach_get("co", positions)
    return positions


def far(positions, vertex, place):
    return math.dist(positions[3 * vertex:3 * vertex + 3], place)


def update_ms(hook, move):
    """Milliseconds from a moved hook to the evaluated mesh."""
    start = time.perf_counter()
    hook.location = move
    bpy.context.view_layer.update()
    return 1e3 * (time.perf_counter() - start)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    moves = int(arguments[2]) if len(arguments) > 2 else MOVES
    vertices, faces, anchors, handle = read_scene(arguments[0])

    def rest(vertex):
        return vertices[3 * vertex:3 * vertex + 3]

    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    thing = make_object(vertices, faces)
    # Moved by a hook: a changed mesh, or a changed setting, would make Blender factorise anew at each update.
    hook = bpy.data.objects.new("hook", None)
    bpy.context.collection.objects.link(hook)
    bpy.context.view_layer.update()
    mover = thing.modifiers.new("move", "HOOK")
    mover.object = hook
    mover.vertex_indices_set([handle])
    thing.vertex_groups.new(name=GROUP).add(list(anchors) + [handle], 1.0, "REPLACE")
    modifier = thing.modifiers.new("laplacian", "LAPLACIANDEFORM")
    modifier.vertex_group = GROUP
    modifier.iterations = 1

    def base_ms():
        modifier.show_viewport = False
        update_ms(hook, handle_move(0))
        times = [update_ms(hook, handle_move(frame)) for frame in range(1, moves + 1)]
        hook.location = (0, 0, 0)
        modifier.show_viewport = True
        bpy.context.view_layer.update()
        return times

    base = base_ms()
    start = time.perf_counter()
    bpy.ops.object.laplaciandeform_bind(modifier=modifier.name)
    bpy.context.view_layer.update()
    bind_ms = 1e3 * (time.perf_counter() - start)
    if not modifier.is_bind:
        sys.exit("blender_laplacian.py: the modifier could not be bound")

    update_ms(hook, handle_move(0))
    around = neighbours(faces, handle)
    times, error = [], 0.0
    for frame in range(1, moves + 1):
        move = handle_move(frame)
        times.append(update_ms(hook, move))
        positions = evaluated(thing)
        target = [a + b for a, b in zip(rest(handle), move)]
        error = max(error, far(positions, handle, target) / math.hypot(*move))
        # The handle alone proves little: its neighbours have to have come along.
        followed = min(far(positions, v, rest(v)) for v in around)
        if not followed > 0.1 * math.hypot(*move):
            sys.exit("blender_laplacian.py: the surface did not follow the handle")
    if not error <= BOUND:
        sys.exit(f"blender_laplacian.py: the handle stays behind by {error} of its way")
    base = statistics.median(base + base_ms())
    with open(arguments[1], "w", encoding="utf-8") as file:
        json.dump({
            "version": bpy.app.version_string,
            "vertices": len(vertices) // 3,
            "bind_ms": bind_ms,
            "base_ms": base,
            "update_ms": [ms - base for ms in times],
            "error": error,
            "bound": BOUND
        }, file, indent=1)


def neighbours(faces, vertex):
    found = set()
    for start in range(0, len(faces), 3):
        face = faces[start:start + 3]
        if vertex in face:
            found.update(face)
    return found - {vertex}


if __name__ == "__main__":
    main()
