-- Prints what Neovim shows of the open scene. Started by tests/editors.rs.

local PATIENCE = 20000

local function main()
  io.write('filetype: ' .. vim.bo.filetype .. '\n')
  vim.wait(PATIENCE, function() return #vim.diagnostic.get(0) > 0 end, 10)
  for _, diagnostic in ipairs(vim.diagnostic.get(0)) do
    io.write('fault: ' .. diagnostic.message .. '\n')
  end
  vim.fn.search('fov')
  local position = vim.api.nvim_win_get_cursor(0)
  local answers = vim.lsp.buf_request_sync(0, 'textDocument/hover', {
    textDocument = { uri = vim.uri_from_bufnr(0) },
    position = { line = position[1] - 1, character = position[2] },
  }, PATIENCE)
  for _, answer in pairs(answers or {}) do
    io.write('hover: ' .. answer.result.contents.value .. '\n')
  end
end

local done, problem = pcall(main)
if not done then
  io.write(tostring(problem) .. '\n')
end
vim.cmd('qall!')
