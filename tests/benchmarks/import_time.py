"""How long `import shadelab` takes beyond NumPy's own import: medians over fresh interpreters, in one run.

python tests/benchmarks/import_time.py
"""

import statistics
import subprocess
import sys


def seconds(statement: str) -> float:
    """Time a statement in a fresh interpreter."""
    code = f"import time; t = time.perf_counter(); {statement}; print(time.perf_counter() - t)"
    return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)


def main() -> None:
    """Print the table."""
    pairs = [(seconds("import numpy"), seconds("import numpy, shadelab")) for _ in range(21)]
    numpy, both = (statistics.median(column) for column in zip(*pairs, strict=True))
    print(f"{'import':24} {'median s':>9}")
    print(f"{'numpy':24} {numpy:9.3f}")
    print(f"{'numpy and shadelab':24} {both:9.3f}")
    print(f"{'shadelab beyond numpy':24} {both - numpy:9.3f}")


if __name__ == "__main__":
    main()
