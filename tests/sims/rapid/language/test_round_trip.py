"""Programs made at random, written as source, are read back as they were made."""

from hypothesis import given
from hypothesis import strategies as st

from sims.rapid import ast
from sims.rapid.lexer import KEYWORDS
from sims.rapid.parser import parse_text

AT = ast.Place("x", 1, 1)
LEVELS = {"OR": 1, "XOR": 1, "AND": 2, "=": 3, "<": 3, ">=": 3, "<>": 3, "+": 4, "-": 4}
LEVELS |= {"*": 5, "/": 5, "DIV": 5, "MOD": 5}

names = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,6}", fullmatch=True).filter(
    lambda name: name.upper() not in KEYWORDS
)
name_nodes = names.map(lambda name: ast.Name(AT, name))
literals = st.one_of(
    st.integers(0, 10**6).map(lambda n: ast.Number(AT, float(n), str(n))),
    st.sampled_from([".5", "1E3", "2.", "0xFF"]).map(
        lambda t: ast.Number(AT, float(int(t, 16)) if "x" in t else float(t), t)
    ),
    st.booleans().map(lambda b: ast.BoolLiteral(AT, b)),
    st.text('aé"\\\n! {', max_size=6).map(lambda s: ast.StringLiteral(AT, s)),
)


def _deeper(inner: st.SearchStrategy[ast.Expr]) -> st.SearchStrategy[ast.Expr]:
    parts = st.recursive(
        name_nodes,
        lambda base: st.one_of(
            st.builds(ast.Field, st.just(AT), base, names),
            st.builds(
                ast.Index, st.just(AT), base, st.lists(inner, min_size=1, max_size=2).map(tuple)
            ),
        ),
        max_leaves=2,
    )
    return st.one_of(
        parts,
        st.builds(ast.Binary, st.just(AT), st.sampled_from(sorted(LEVELS)), inner, inner),
        st.builds(ast.Unary, st.just(AT), st.sampled_from(["-", "+", "NOT"]), inner),
        st.builds(ast.Aggregate, st.just(AT), st.lists(inner, min_size=1, max_size=3).map(tuple)),
        st.builds(ast.Call, st.just(AT), names, st.lists(_arguments(inner), max_size=3).map(tuple)),
    )


def _arguments(inner: st.SearchStrategy[ast.Expr]) -> st.SearchStrategy[ast.Argument]:
    return st.one_of(
        st.builds(ast.Argument, st.just(AT), st.none(), inner),
        st.builds(ast.Argument, st.just(AT), names, st.one_of(st.none(), inner), st.just(True)),
        st.builds(ast.Argument, st.just(AT), names, st.none(), st.just(True), name_nodes),
    )


exprs = st.recursive(st.one_of(literals, name_nodes), _deeper, max_leaves=8)


def _blocks(inner: st.SearchStrategy[ast.Statement]) -> st.SearchStrategy[ast.Statement]:
    body = st.lists(inner, max_size=3).map(tuple)
    branch = st.tuples(exprs, body)
    case = st.tuples(st.lists(exprs, min_size=1, max_size=2).map(tuple), body)
    at = st.just(AT)
    return st.one_of(
        st.builds(ast.If, at, st.lists(branch, min_size=1, max_size=2).map(tuple), body),
        st.builds(ast.While, at, exprs, body),
        st.builds(ast.For, at, names, exprs, exprs, st.one_of(st.none(), exprs), body),
        st.builds(ast.Test, at, exprs, st.lists(case, max_size=2).map(tuple), st.none() | body),
    )


simple = st.one_of(
    st.builds(ast.Assign, st.just(AT), name_nodes, exprs),
    st.builds(ast.ProcCall, st.just(AT), names, st.lists(_arguments(exprs), max_size=3).map(tuple)),
    st.builds(ast.Label, st.just(AT), names),
    st.builds(ast.Goto, st.just(AT), names),
    st.builds(ast.Return, st.just(AT), st.none() | exprs),
    st.builds(ast.Connect, st.just(AT), name_nodes, names),
    st.just(ast.Retry(AT)),
    st.just(ast.Exit(AT)),
)
statements = st.recursive(simple, _blocks, max_leaves=6)


def source(node: object) -> str:
    """Write a node, each operation in parentheses."""
    match node:
        case ast.Number():
            return node.text
        case ast.StringLiteral():
            text = node.value.replace("\\", "\\\\").replace('"', '""').replace("\n", "\\0A")
            return f'"{text}"'
        case ast.BoolLiteral():
            return str(node.value)
        case ast.Name():
            return node.name
        case ast.Aggregate():
            return "[" + ",".join(map(source, node.items)) + "]"
        case ast.Field():
            return f"{source(node.base)}.{node.name}"
        case ast.Index():
            return source(node.base) + "{" + ",".join(map(source, node.indices)) + "}"
        case ast.Unary():
            return f"({node.op} {source(node.operand)})"
        case ast.Binary():
            return f"({source(node.left)} {node.op} {source(node.right)})"
        case ast.Call():
            return f"{node.name}({_given(node.arguments)})"
    return _statement(node)


def _given(arguments: tuple[ast.Argument, ...]) -> str:
    parts = []
    for item in arguments:
        if item.name is None:
            parts.append(source(item.value))
        elif item.condition is not None:
            parts.append(f"\\{item.name}?{item.condition.name}")
        else:
            parts.append(f"\\{item.name}" + (f":={source(item.value)}" if item.value else ""))
    return ", ".join(parts)


def _body(nodes: tuple[ast.Statement, ...]) -> str:
    return "\n".join(_statement(node) for node in nodes) + "\n"


def _statement(node: object) -> str:
    match node:
        case ast.Assign():
            return f"{source(node.target)} := {source(node.value)};"
        case ast.ProcCall():
            return f"{node.name} {_given(node.arguments)};"
        case ast.Label():
            return f"{node.name}:"
        case ast.Goto():
            return f"GOTO {node.label};"
        case ast.Return():
            return f"RETURN {'' if node.value is None else source(node.value)};"
        case ast.Connect():
            return f"CONNECT {source(node.target)} WITH {node.trap};"
        case ast.Retry():
            return "RETRY;"
        case ast.Exit():
            return "EXIT;"
    return _compound(node)


def _compound(node: object) -> str:
    match node:
        case ast.While():
            return f"WHILE {source(node.condition)} DO\n{_body(node.body)}ENDWHILE"
        case ast.For():
            step = "" if node.step is None else f" STEP {source(node.step)}"
            head = f"FOR {node.variable} FROM {source(node.first)} TO {source(node.last)}{step} DO"
            return f"{head}\n{_body(node.body)}ENDFOR"
        case ast.If():
            words = ["IF"] + ["ELSEIF"] * (len(node.branches) - 1)
            text = "".join(
                f"{word} {source(condition)} THEN\n{_body(body)}"
                for word, (condition, body) in zip(words, node.branches, strict=True)
            )
            return text + (f"ELSE\n{_body(node.otherwise)}" if node.otherwise else "") + "ENDIF"
        case ast.Test():
            text = f"TEST {source(node.subject)}\n"
            for values, body in node.cases:
                text += f"CASE {','.join(map(source, values))}:\n{_body(body)}"
            if node.default is not None:
                text += f"DEFAULT:\n{_body(node.default)}"
            return text + "ENDTEST"
    raise AssertionError(node)


def unplaced(node: object) -> object:
    """A node as nested tuples, without places."""
    if isinstance(node, tuple):
        return tuple(unplaced(item) for item in node)
    if not hasattr(node, "__dataclass_fields__"):
        return node
    kept = [name for name in node.__dataclass_fields__ if name != "at"]
    return (type(node).__name__, *(unplaced(getattr(node, name)) for name in kept))


@given(st.lists(statements, max_size=4).map(tuple))
def test_a_program_is_read_back_as_it_was_made(body: tuple[ast.Statement, ...]) -> None:
    text = f"MODULE m\nPROC p()\n{_body(body)}ENDPROC\nENDMODULE"
    modules, wrong = parse_text(text, "x")
    assert not wrong, [str(item) for item in wrong]
    (routine,) = modules[0].declarations
    assert isinstance(routine, ast.RoutineDecl)
    assert unplaced(routine.body) == unplaced(body)


@given(st.lists(st.sampled_from(sorted(LEVELS)), min_size=1, max_size=8))
def test_operators_bind_by_priority_and_then_to_the_left(operators: list[str]) -> None:
    flat = "a" + "".join(f" {op} a" for op in operators)

    def bound(ops: list[str]) -> str:
        if not ops:
            return "a"
        weakest = min(LEVELS[op] for op in ops)
        last = max(k for k, op in enumerate(ops) if LEVELS[op] == weakest)
        return f"({bound(ops[:last])} {ops[last]} {bound(ops[last + 1 :])})"

    texts = [
        f"MODULE m\nPROC p()\nx := {text};\nENDPROC\nENDMODULE" for text in (flat, bound(operators))
    ]
    trees = [parse_text(text, "x")[0][0].declarations[0] for text in texts]
    bodies = [tree.body for tree in trees if isinstance(tree, ast.RoutineDecl)]
    assert unplaced(bodies[0]) == unplaced(bodies[1])
