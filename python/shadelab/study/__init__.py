"""The trade between speed and accuracy, measured."""
