"""The extremes of each chapter, one file a chapter or part of one (see `shadelab.study.stability`)."""
