"""A small controller of a user's own, as text and as data."""

from __future__ import annotations

THREE = """\
name: three by three
inputs:
  distance:
    range: [0, 5]
    sets:
      near: {trapezoidal: [0, 0, 1, 2.5]}
      middle: {triangular: [1, 2.5, 4]}
      far: {trapezoidal: [2.5, 4, 5, 5]}
  difference:
    range: [-5, 5]
    sets:
      right: {words: right freer, trapezoidal: [-5, -5, -3, 0]}
      alike: {bell: [0, 1.5, 2]}
      left: {words: left freer, trapezoidal: [0, 3, 5, 5]}
outputs:
  turn:
    range: [-2, 2]
    sets:
      R: {words: right, singleton: -1.5}
      S: {words: straight, singleton: 0}
      L: {words: left, singleton: 1.5}
  step:
    range: [0, 2]
    sets:
      short: {singleton: 0.2}
      long: {singleton: 2}
rules:
  #       right    alike    left
  near:   [R short, S short, L short]
  middle: [R long,  S long,  L long]
  far:    [S long,  S long,  S long]
inference: {and: minimum, defuzzification: average}
"""
"""Three labels an input, all kinds of sets but the Gaussian, minimum and average."""

SMOOTH = """\
inputs:
  distance:
    range: [0, 5]
    sets:
      near: {gaussian: [0, 1.5]}
      far: {gaussian: [5, 1.5]}
  difference:
    range: [-5, 5]
    sets:
      a: {gaussian: [-5, 1.5]}
      b: {gaussian: [-1.5, 1]}
      c: {gaussian: [1.5, 1]}
      d: {gaussian: [5, 1.5]}
outputs:
  turn:
    range: [-2, 2]
    sets:
      R: {triangular: [-3, -2, 0]}
      L: {triangular: [0, 2, 3]}
  step:
    range: [0, 2]
    sets:
      short: {trapezoidal: [0, 0, 0.4, 0.9]}
      long: {bell: [2, 0.8, 3]}
rules:
  near: [R short, R short, L short, L short]
  far: [R long, R long, L long, L long]
"""
"""Two by four, with a centroid."""
