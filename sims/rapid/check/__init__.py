"""What is wrong with a program, told before it runs.

Errors are certain: a controller that has these modules, and no others, in this task refuses them
or cannot run them. What depends on what is reached, on other modules or on signals that nobody
named is a warning or nothing at all.
"""

from collections.abc import Collection, Mapping, Sequence

from sims.rapid.ast import AliasDecl, DataDecl, Module, RecordDecl, RoutineDecl
from sims.rapid.builtin import TaskKind
from sims.rapid.check.calls import Calls
from sims.rapid.check.declarations import (
    check_data,
    check_record,
    check_twice,
    check_with_others,
)
from sims.rapid.check.expressions import Expressions
from sims.rapid.check.routines import check_routine
from sims.rapid.check.scope import Names
from sims.rapid.errors import Diagnostic

__all__ = ["check"]


def check(
    modules: Sequence[Module],
    *,
    kind: TaskKind,
    has_motion: bool,
    signals: Collection[str] | None,
    others: Mapping[str, Sequence[Module]] | None = None,
    extra: Collection[str] = (),
    same_task: bool = True,
) -> list[Diagnostic]:
    """Check the modules of one task together; the built-ins have to be registered.

    Parameters
    ----------
    modules
        All modules of the task.
    kind, has_motion
        What the task is: some instructions belong to motion tasks, others to background tasks.
    signals
        The names of all signals. None when they are not known: then an undeclared name in an
        expression is only a warning.
    others
        The modules of the other tasks, by task: their persistents share names with these.
    extra
        Names of data that the controller itself adds, such as ``ROB_1`` and ``T_ROB1Id``.
    same_task
        False when it is not certain that the modules are of one task: then a name that stands in
        two of them is only a warning.

    Returns
    -------
    diagnostics
        In the order of the sources. Certain, and so errors, are: unknown and circular types;
        unknown data where signals are known; names that stand twice; wrong number of arguments,
        unknown and excluding options, a CONST for VAR, PERS or INOUT, a VAR for PERS; assignments
        and arguments of a type that cannot be converted; assignment to CONST or the variable of
        FOR; RETURN, RAISE, RETRY, TRYNEXT, GOTO and CONNECT where they cannot stand; persistents
        whose types differ between tasks; what belongs to options that are not offered.
    """
    tasks = others or {}
    found = check_twice(modules, same_task=same_task)
    found += check_with_others(modules, tasks)
    ids = [f"{task}Id" for task in tasks]
    names = Names.of(modules, signals, [*extra, *ids])
    for module in modules:
        expressions = Expressions(module.name, names, found, module.lines)
        calls = Calls(expressions, kind, has_motion)
        for decl in module.declarations:
            match decl:
                case DataDecl():
                    check_data(decl, expressions)
                case RecordDecl() | AliasDecl():
                    check_record(decl, expressions)
                case RoutineDecl():
                    check_routine(decl, expressions, calls)
    order = {module.at.source: k for k, module in enumerate(modules)}
    return sorted(
        found, key=lambda d: (order.get(d.at.source, 0), d.at.line, d.at.column, d.message)
    )
