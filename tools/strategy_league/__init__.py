"""The league of strategies: jobs of league.toml, run, measured and compared."""
