"""Components and elements: what they are of, and what they look like."""

from sims.rapid import ast
from sims.rapid.symbols import LinkError
from sims.rapid.types import Shape, Type

__all__ = ["component", "indexed", "is_record", "parts", "unfold"]


def unfold(expr: ast.Expr) -> tuple[list[ast.Field | ast.Index], ast.Expr]:
    """Return the steps from the base outwards, and the base."""
    steps: list[ast.Field | ast.Index] = []
    node = expr
    while isinstance(node, ast.Field | ast.Index):
        steps.append(node)
        node = node.base
    return steps[::-1], node


def component(shape: Shape, step: ast.Field) -> tuple[int, Shape]:
    """Return the place and the shape of a component. Raises ``LinkError``."""
    k = None if shape.dims else shape.type.position(step.name)
    if k is None:
        raise LinkError(step.at, f"{shape} has no component {step.name}")
    kind: Type = shape.type.fields[k][1]
    return k, Shape(kind, (), kind.name)


def indexed(shape: Shape, step: ast.Index) -> Shape:
    """Return the shape of an element. Raises ``LinkError``."""
    if len(step.indices) != len(shape.dims):
        raise LinkError(step.at, f"{shape} has {len(shape.dims)} dimensions: give as many indices")
    if any(index is None for index in step.indices):
        raise LinkError(step.at, "* is no index here")
    return Shape(shape.type, (), shape.declared)


def parts(shape: Shape, count: int, at: ast.Place) -> list[Shape]:
    """Return the shapes of an aggregate's items. Raises ``LinkError``."""
    if shape.dims:
        if shape.dims[0] not in {0, count}:
            raise LinkError(at, f"{shape.dims[0]} values are needed for {shape}, not {count}")
        return [Shape(shape.type, shape.dims[1:], shape.declared)] * count
    fields = shape.type.fields
    if len(fields) != count:
        raise LinkError(at, f"{shape} has {len(fields)} components, not {count}")
    return [Shape(kind, (), kind.name) for _, kind in fields]


def is_record(shape: Shape, name: str) -> bool:
    """Whether it is a scalar of this record."""
    return not shape.dims and shape.type.name == name
