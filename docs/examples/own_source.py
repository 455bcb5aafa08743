#!/usr/bin/env python3
"""A source of error as a program: glass. Some edges are missed, some have a ghost beside them."""
import json
import random
import sys

MISSED, GHOSTS = 0.2, 0.1  # shares of the edges of a view


def ghost(edge, aside_px):
    """The edge once more, as far away as it is itself."""
    return {key: [edge[key][0] + aside_px, edge[key][1], edge[key][2] + aside_px, edge[key][3]]
            for key in ('left_px', 'right_px')}


hello = json.loads(sys.stdin.readline())
width = hello['cameras'][0]['size_px'][0]
print(json.dumps({'ready': True}), flush=True)
for line in sys.stdin:
    view = json.loads(line)
    kept, ghosts = [], []
    for edge in view['edges']:
        # By what the edge is, never by its place in the list, so that no other draw changes.
        draws = random.Random(f"{view['seed']} {view['trial']} {view['frame']} {edge['id']}")
        missed, doubled, aside_px = draws.random(), draws.random(), draws.uniform(5, 0.1 * width)
        if missed >= MISSED:
            kept.append({'id': edge['id']})
        if doubled < GHOSTS:
            ghosts.append(ghost(edge, aside_px))
    print(json.dumps({'question': view['question'], 'edges': kept + ghosts}), flush=True)
