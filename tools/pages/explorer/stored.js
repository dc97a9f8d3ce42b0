// Stored answers in place of the server, for the copy of the page that only shows them.

window.fetch = async (path, { body }) => {
  const { start, cases } = window.stored;
  const reply = (status, answer) => ({ ok: status === 200, status, json: async () => answer });
  if (path === "/api/start") return reply(200, start);
  const { groups, quantity } = JSON.parse(body);
  const found = cases.find((item) => JSON.stringify(item.groups) === JSON.stringify(groups));
  if (!found) return reply(422, { error: "This copy has no such state: run rwmf explore." });
  if (path === "/api/history") return reply(200, found.history);
  const spectrum = quantity ? found.spectra[quantity] : Object.values(found.spectra)[0];
  return spectrum ? reply(200, spectrum) : reply(422, { error: found.problem });
};
