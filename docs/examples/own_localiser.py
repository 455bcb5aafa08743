#!/usr/bin/env python3
"""A localiser as a program: the map's node that shares most upright lines with the query."""
import json
import math
import sys


def uprights(view):
    """Bearing and range of the vertical lines."""
    middles = [[(a + b) / 2 for a, b in zip(line['a_m'], line['b_m'])]
               for line in view['lines'] if line['kind'] == 'vertical']
    return [(math.atan2(y, x), math.hypot(x, y)) for x, y, _ in middles]


def shared(query, node):
    """How many of the query's lines lie near one of the node's."""
    return sum(any(abs(bearing - b) < 0.06 and abs(far / r - 1) < 0.1 for b, r in node)
               for bearing, far in query)


hello = json.loads(sys.stdin.readline())
nodes = [json.loads(sys.stdin.readline()) for _ in range(hello['nodes'])]
known = [uprights(node) for node in nodes]
print(json.dumps({'ready': True}), flush=True)
for line in sys.stdin:
    query = json.loads(line)
    seen = uprights(query['looks'][0])
    scores = [shared(seen, node) for node in known]
    best = max(range(len(nodes)), key=scores.__getitem__)
    if scores[best] < 3:
        answer = {'status': 'no_match'}
    else:
        answer = {'status': 'answered', 'node': best, 'pose': nodes[best]['pose'],
                  'score': scores[best]}
    print(json.dumps({'question': query['question'], **answer}), flush=True)
