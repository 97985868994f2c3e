"""The figures of the documents: each file measures and draws one."""
