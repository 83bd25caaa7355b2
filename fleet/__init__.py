"""Many robots, many recordings: which machine changed, since when, and what.

Catalogue -> engine (Dask) -> identify, trace and predict as processes -> journal -> Parquet -> change points -> page. The programs are
used through their command lines and files only (docs/fleet.md).
"""
