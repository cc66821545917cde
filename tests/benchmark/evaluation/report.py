"""A Markdown file with tables and pictures."""
from evaluation import methods as m


class Report:
    def __init__(self, folder, name="report.md"):
        self.folder = folder
        self.name = name
        self.lines = []

    def say(self, *paragraphs):
        for text in paragraphs:
            self.lines += [text, ""]

    def table(self, titles, rows):
        for cells in (titles, ["---"] * len(titles), *rows):
            self.lines.append("| " + " | ".join(map(str, cells)) + " |")
        self.lines.append("")

    def picture(self, labels, name, *options):
        m.madf("render", labels, self.folder / f"{name}.png", *options)
        return f"![{name}]({name}.png)"

    def write(self):
        fresh = self.folder / f"{self.name}.part"
        fresh.write_text("\n".join(self.lines))
        fresh.rename(self.folder / self.name)
