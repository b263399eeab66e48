"""Tables of parameters: which changes a row makes, and what is wrong with one, in words."""

import pytest
from example_cases import write

from parsim.__main__ import main
from parsim.case.runs_table import row, rows
from parsim.errors import InputError

KEYS = "spacing,run.until,water.fill.0.max\n"


@pytest.fixture
def table(tmp_path):
    def made(text, encoding="utf-8"):
        path = tmp_path / "table.csv"
        path.write_bytes(text.encode(encoding))
        return path

    return made


def test_a_row_is_changes_of_the_case(table):
    path = table(KEYS + '0.01,1.0,"[0.2, 0.1, 0.1]"\n\n# finer\n 0.005 ,,"[0.2, 0.1, 0.05]"\n')
    assert rows(path) == [
        ["spacing=0.01", "run.until=1.0", "water.fill.0.max=[0.2, 0.1, 0.1]"],
        ["spacing=0.005", "water.fill.0.max=[0.2, 0.1, 0.05]"],
    ]
    assert row(path, 2) == rows(path)[1]


def test_tables_of_spreadsheets_are_read(table):
    assert rows(table("spacing,run.until\r\n0.01,1\r\n", "utf-8-sig")) == [["spacing=0.01", "run.until=1"]]


@pytest.mark.parametrize(("text", "said"), [
    ("", "holds no row"),
    (KEYS, "holds no row"),
    ("spacing,,x\n1,2,3\n", "column 2 names no key"),
    (KEYS + "1,2\n1,2,3,4\n", "row 1 has 2 values for 3 keys\n.*row 2 has 4 values"),
    (KEYS + '1,"2,3\n', "not a CSV table"),
])  # fmt: skip
def test_a_faulty_table_is_refused(table, text, said):
    with pytest.raises(InputError, match=said):
        rows(table(text))


def test_a_table_that_is_no_text_or_not_there_is_refused(table, tmp_path):
    path = table("")
    path.write_bytes(b"a,b\n\xff\xfe,1\n")
    with pytest.raises(InputError, match="not a CSV table in UTF-8"):
        rows(path)
    with pytest.raises(InputError, match="none.csv: cannot be read: No such file"):
        rows(tmp_path / "none.csv")


@pytest.mark.parametrize("number", [0, -1, 3])
def test_a_row_that_is_not_there_is_refused(table, number):
    with pytest.raises(InputError, match=f"--row = {number}: .* has 2 rows; allowed: 1 to 2"):
        row(table("spacing\n0.1\n0.2\n"), number)


def test_check_looks_at_every_row(table, tmp_path, capsys):
    case = str(write(tmp_path)["2d"])
    assert main(["check", case, "--table", str(table("run.until\n1.0\n2.0\n"))]) == 0
    out = capsys.readouterr().out
    assert "every row is a valid case, for --array=1-2" in out and "row 2 " in out and "run.until=2.0" in out
    assert main(["check", case, "--table", str(table("run.until,spacing\n1.0,0.01\n-1.0,0.01\n1.0,0.3\n"))]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3 and "row 2: run.until = -1.0" in said[0] and all("row 3: " in line for line in said[1:])


def test_run_takes_a_row(table, tmp_path, capsys):
    import parsim

    case, out, path = str(write(tmp_path)["2d"]), tmp_path / "out", str(table("run.until,spacing\n0.01,0.02\n"))
    assert main(["run", case, "-o", str(out), "--table", path]) == 2
    assert "--table TABLE and --row N belong together" in capsys.readouterr().err
    assert main(["run", case, "-o", str(out), "--table", path, "--row", "1"]) == 0
    assert parsim.open(out).case["spacing"] == 0.02 and parsim.open(out).case["run"]["until"] == 0.01
