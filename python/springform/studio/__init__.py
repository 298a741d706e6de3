"""The studio's engine: it owns documents, moves their nets, and serves both to browsers."""
