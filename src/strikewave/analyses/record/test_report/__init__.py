"""The test report of a laboratory: what was asked, with what it was tested, each shock with its verdict, signatures."""
