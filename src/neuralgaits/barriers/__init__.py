"""Conditions on regions of the zero dynamics, and the specifications built from them."""

from neuralgaits.barriers import functions, specs
from neuralgaits.barriers.conditions import (
    AbstractCondition,
    Barrier,
    DiscreteBarrier,
    Equality,
    Fence,
    Inlet,
    Pointwise,
    TubeWidth,
)
from neuralgaits.barriers.quantity_words import quantity
from neuralgaits.barriers.regions import Box
from neuralgaits.barriers.spec import GaitSpec, Recipe
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.tubes import Tube

__all__ = [
    "AbstractCondition",
    "Barrier",
    "Box",
    "DiscreteBarrier",
    "Equality",
    "Fence",
    "Gait",
    "GaitSpec",
    "Inlet",
    "Pointwise",
    "Recipe",
    "Tube",
    "TubeWidth",
    "functions",
    "quantity",
    "specs",
]
