"""The extremes of each chapter, one file a chapter (see `shadelab.study.stability`)."""
