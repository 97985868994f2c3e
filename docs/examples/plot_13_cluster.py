"""
Run a batch on a dask cluster
=============================

A large batch can run on threads, on processes, or on a dask cluster. Does the choice change the numbers? This page runs
one scene on threads and on a cluster of two workers on this machine, and compares them bit by bit.
"""

from dask.distributed import Client, LocalCluster

import roughmdr as rm

# %%
# The scene is a batch of 64 realisations with adhesion.

SCENE = {
    "title": "Rubber on rough glass",
    "seed": 2026,
    "material": {"modulus": "3 MPa", "poisson": 0.49},
    "adhesion": {"model": "jkr", "work": "20 mJ/m^2"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 1000,
        "patch": "1 mm",
        "height": {"distribution": "normal", "std": "1 um"},
        "radius": {"distribution": "lognormal", "mean": "100 um", "std": "10 um"},
    },
    "path": {"separation": {"start": "clear", "stop": "1.5 sigma", "steps": 60}, "unload": True},
    "batch": {"realizations": 64},
}
threads = rm.run(SCENE, workers=2)

# %%
# Start the cluster and give its client to ``rm.run``. Bind everything to 127.0.0.1, the dashboard too: a scheduler or a
# dashboard that is not told so may listen on every interface, to anyone.
#
# The two workers of this page are threads that talk over TCP (``processes=False``), so that it runs anywhere. Leave
# that out in a script of your own to have worker processes, and start them below ``if __name__ == "__main__":``.

settings = {
    "n_workers": 2,
    "threads_per_worker": 1,
    "processes": False,
    "protocol": "tcp://",
    "host": "127.0.0.1",
    "dashboard_address": "127.0.0.1:0",
}
with LocalCluster(**settings) as cluster, Client(cluster) as client:
    on_cluster = rm.run(SCENE, scheduler=client)
    threads_of_workers = client.nthreads()
print(sorted(threads_of_workers.values()))

# %%
# Compare the bytes of every variable. All are the same but the run time: random numbers belong to a realisation and not
# to a worker, and sums are taken in a fixed order.

same = {name: threads[name].values.tobytes() == on_cluster[name].values.tobytes() for name in threads.data_vars}
f"{sum(same.values())} of {len(same)} variables have the same bits, all but {[n for n in same if not same[n]]}"

# %%
# So you can start a batch on a laptop and go on with it on a cluster. Give ``rm.run`` an output file: what is finished
# is kept beside it, and the same call goes on after an interruption.

figure = rm.plot(on_cluster, variables="force", with_expected=True)

# %%
# On SLURM
# --------
#
# Replace ``LocalCluster`` by the ``SLURMCluster`` of dask-jobqueue. Nothing else changes:
#
# .. code-block:: python
#
#     from dask.distributed import Client
#     from dask_jobqueue import SLURMCluster
#
#     import roughmdr as rm
#
#     with SLURMCluster(cores=16, processes=4, memory="32 GB", walltime="04:00:00", interface="ib0") as cluster:
#         cluster.scale(jobs=4)
#         with Client(cluster) as client:
#             law = rm.run("scene.toml", "out.nc", scheduler=client)
#
# - ``cores`` and ``processes`` are those of one job: 4 jobs with 4 worker processes of 4 threads each.
# - Workers may come and go. A task whose worker dies is computed by another one.
# - All workers must have the same versions of the packages, and processors of one kind for the same bits.
# - Beyond one machine use TLS. The interface of the cluster's own network, here ``ib0``, is no protection by itself.
