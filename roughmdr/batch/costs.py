"""About what a run takes: by which batches are cut into tasks, and the cheapest way to an asked error is chosen.

Seconds on one core of a small server (``pipelines/work_precision.py``, ``pipelines/scaling.py``), right to a factor of
three or so. They are constants, never measured while a batch runs, so that every machine chooses alike.
"""

from roughmdr.batch.plan import Cell

_RUN, _DRAW = 1.5e-4, 2e-7  # to begin a run, to draw and sort an asperity
_EVEN = 8e-4  # to begin evenly spread draws
_VISIT, _VISIT_CURVED, _VISIT_COHESIVE, _VISIT_COHESIVE_CURVED = 5e-9, 1.2e-7, 1.5e-7, 4e-5  # of an asperity at a step
# An expected law: its tables, a step, and for each node of its first rule squared, since it takes more nodes where
# more parameters are drawn, a step without adhesion and with it; so many times more where each node has its own table.
_TABLES, _TABLES_COHESIVE_CURVED, _STEP, _NODE, _NODE_ADHESIVE, _OWN_TABLES = 3e-3, 5e-2, 2e-5, 1e-6, 2e-5, 5.0
_FIRST_RULE = 8


def seconds(cell: Cell, estimator: str) -> float:
    """About what one run takes [s]."""
    law, section = cell.scene.adhesion_model, cell.scene.asperities
    steps = cell.path.separation.size
    simple = section.shape_name == "paraboloid" or not law.work
    cohesive = "dugdale" in law.candidates
    if estimator == "expected":
        nodes = section.node_count(_FIRST_RULE)
        node = (_NODE_ADHESIVE if law.work else _NODE) * (1.0 if simple else _OWN_TABLES)
        tables = _TABLES_COHESIVE_CURVED if cohesive and not simple else _TABLES
        return tables + steps * (_STEP + (nodes * nodes * node if nodes > 1 else 0.0))
    plain, curved = (_VISIT_COHESIVE, _VISIT_COHESIVE_CURVED) if cohesive else (_VISIT, _VISIT_CURVED)
    visit = plain if simple else curved
    begin = _RUN + (_EVEN if estimator == "stratified" else 0.0)
    return begin + section.expected_count * (_DRAW + visit * steps)
