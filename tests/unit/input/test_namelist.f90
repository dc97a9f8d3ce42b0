!> Text helpers, checksum and the splitting of namelist text.
program test_namelist
   use check, only: checks_t
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_namelist, only: group_t, parse_namelist
   use rwmf_text_crc32, only: crc32
   use rwmf_text_strings, only: integer_to_text, nearest_name, parse_integer, parse_real, &
      real_to_text
   implicit none

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: crlf = achar(13)//achar(10)
   type(checks_t) :: checks

   if (checks%wants('checksum')) call test_checksum()
   if (checks%wants('real_to_text')) call test_real_to_text()
   if (checks%wants('round_trip')) call test_round_trip()
   if (checks%wants('parse_real')) call test_parse_real()
   if (checks%wants('parse_integer')) call test_parse_integer()
   if (checks%wants('nearest_name')) call test_nearest_name()
   if (checks%wants('groups')) call test_groups()
   if (checks%wants('line_ends')) call test_line_ends()
   if (checks%wants('errors')) call test_errors()
   call checks%finish()

contains

   !> The check value in the definition of the CRC, and the empty text.
   subroutine test_checksum()
      call checks%that(crc32('123456789') == 'cbf43926', 'check value', crc32('123456789'))
      call checks%that(crc32('') == '00000000', 'crc of nothing')
   end subroutine test_checksum

   subroutine test_real_to_text()
      real(wp), parameter :: values(9) = [0.0_wp, 1.0_wp, -2.5_wp, 1.0e-9_wp, 123456.0_wp, &
         1.0e15_wp, -0.00025_wp, 1.0e-300_wp, 0.1_wp]
      character(9), parameter :: texts(9) = [character(9) :: '0.0', '1.0', '-2.5', '1.0e-9', &
         '123456.0', '1.0e15', '-0.00025', '1.0e-300', '0.1']
      integer :: i

      do i = 1, size(values)
         call checks%that(real_to_text(values(i)) == texts(i), 'text of '//trim(texts(i)), &
            trim(real_to_text(values(i))))
      end do
      call checks%that(integer_to_text(-huge(1)) == '-2147483647', 'text of an integer')
   end subroutine test_real_to_text

   !> Writing and reading gives the same bits, for numbers of all sizes and for both reading paths.
   subroutine test_round_trip()
      integer, parameter :: n = 20000
      logical :: ok
      logical :: same
      real(dp) :: back
      real(dp) :: u(2)
      real(dp) :: x
      integer :: i

      call random_init(repeatable=.true., image_distinct=.false.)
      same = .true.
      do i = 1, n
         call random_number(u)
         x = (u(1) - 0.5_dp)*10.0_dp**nint(600*(u(2) - 0.5_dp))
         if (mod(i, 2) == 0) x = real(nint(1.0e6_dp*u(1)), dp)/10.0_dp**nint(12*u(2))
         call parse_real(trim(real_to_text(real(x, wp))), back, ok)
         same = same .and. ok .and. abs(back - x) <= 0
      end do
      call checks%that(same, 'reals survive the way to text and back')
   end subroutine test_round_trip

   subroutine test_parse_real()
      character(9), parameter :: good(10) = [character(9) :: '1', '-.64E-02', '1d3', '5.', &
         '+3.5D+2', '0.1', '1e-400', '000', '1e0005', '.5e1']
      real(dp), parameter :: values(10) = [1.0_dp, -0.0064_dp, 1000.0_dp, 5.0_dp, 350.0_dp, &
         0.1_dp, 0.0_dp, 0.0_dp, 1.0e5_dp, 5.0_dp]
      character(9), parameter :: bad(16) = [character(9) :: '', '.', '-', '1e', '1.0abc', 'nan', &
         'inf', '-Infinity', '1e999', '1..0', '1,2', '3*1', '1/2', '0x10', 'e5', '1.5+3']
      logical :: ok
      real(dp) :: x
      integer :: i

      do i = 1, size(good)
         call parse_real(trim(good(i)), x, ok)
         call checks%that(ok .and. abs(x - values(i)) <= 0, 'number '//trim(good(i)))
      end do
      do i = 1, size(bad)
         call parse_real(trim(bad(i)), x, ok)
         call checks%that(.not. ok, 'not a number: '//trim(bad(i)))
      end do
   end subroutine test_parse_real

   subroutine test_parse_integer()
      character(12), parameter :: bad(7) = [character(12) :: '', '-', '1.0', '2147483648', &
         '99999999999', '1e3', '1 2']
      logical :: ok
      integer :: i
      integer :: value

      call parse_integer('-2147483647', value, ok)
      call checks%that(ok .and. value == -huge(1), 'smallest integer')
      call parse_integer('+007', value, ok)
      call checks%that(ok .and. value == 7, 'integer with sign and zeros')
      do i = 1, size(bad)
         call parse_integer(trim(bad(i)), value, ok)
         call checks%that(.not. ok, 'not an integer: '//trim(bad(i)))
      end do
   end subroutine test_parse_integer

   subroutine test_nearest_name()
      character(5), parameter :: names(3) = ['gamma', 'T_s  ', 'xi_s ']

      call checks%that(nearest_name('gama', names) == 'gamma', 'a letter is missing')
      call checks%that(nearest_name('ts', names) == 'T_s', 'an underscore is missing')
      call checks%that(nearest_name('velocity', names) == '', 'nothing is near')
   end subroutine test_nearest_name

   !> All features of the format in one text.
   subroutine test_groups()
      character(*), parameter :: text = char(239)//char(187)//char(191)//'! a comment'//nl// &
         '&Spectrum GAMMA = 1.0, 2*5.0 ! one, two'//nl//' 10, Spacing=''it''''s / & !'''//nl// &
         'n=3/ &output'//nl//'&end ! last'
      type(error_t), allocatable :: error
      type(group_t), allocatable :: groups(:)

      call parse_namelist(text, groups, error)
      call checks%no_error(error, 'a text with everything')
      if (allocated(error)) return
      call checks%that(size(groups) == 2, 'two groups')
      call checks%that(groups(1)%name == 'spectrum' .and. groups(1)%line == 2, 'first group')
      call checks%that(groups(2)%name == 'output' .and. groups(2)%line == 4 &
         .and. size(groups(2)%entries) == 0, 'empty group')
      associate (entries => groups(1)%entries)
         call checks%that(size(entries) == 3, 'three keys')
         call checks%that(entries(1)%key == 'gamma' .and. size(entries(1)%values) == 4, 'list')
         call checks%that(entries(1)%values(3)%text == '5.0', 'repeated value')
         call checks%that(entries(2)%values(1)%text == "it's / & !" .and. entries(2)%is_quoted, &
            'string with signs and a doubled quote')
         call checks%that(entries(3)%line == 4 .and. .not. entries(3)%is_quoted, 'line of a key')
      end associate
   end subroutine test_groups

   !> Carriage returns and a missing end of the last line have no effect.
   subroutine test_line_ends()
      type(error_t), allocatable :: error
      type(group_t), allocatable :: groups(:)

      call parse_namelist('! dos'//crlf//'&wall h = ''a'''//crlf//'b = 2 /', groups, error)
      call checks%no_error(error, 'carriage returns')
      if (allocated(error)) return
      call checks%that(groups(1)%entries(1)%values(1)%text == 'a', 'value before a line end')
      call checks%that(groups(1)%entries(2)%line == 3, 'lines are counted once')
      call parse_namelist('', groups, error)
      call checks%that(.not. allocated(error) .and. size(groups) == 0, 'no text, no groups')
   end subroutine test_line_ends

   subroutine test_errors()
      call refuse('&wall h = 1', 'line 1: the group &wall is not closed')
      call refuse(nl//'&wall h = 1'//nl//'&frame /', 'line 2: the group &wall is not closed')
      call refuse('&wall h = "abc'//nl//'/', 'line 1: the string "abc')
      call refuse('h = 1', "line 1: 'h' is outside")
      call refuse('&wall h = 1 / /', "'/' is outside")
      call refuse('& /', 'is outside')
      call refuse('&wall h = /', 'h has an empty value')
      call refuse('&wall h = 1,,2 /', 'h has an empty value')
      call refuse('&wall h = = 2 /', 'h has an empty value')
      call refuse('&wall h = 3* /', 'repeated value')
      call refuse('&wall h = 0*1 /', 'repeated value')
      call refuse('&wall h = x*1 /', 'repeated value')
      call refuse('&wall h = 2000000000*1.0 /', 'more than')
      call refuse('&wall h(1) = 1 /', "'h(1)' is not a key")
      call refuse('&wall h /', "'h' is not followed by =")
      call refuse('&wall , /', 'is found where a key')
      call refuse('&wall h = 1'//achar(0)//' /', 'control character')
      call refuse('&a '//repeat('h=1 ', 2000)//'/', 'too many keys')
      call refuse(repeat('&a / ', 2000), 'too many groups')
      call refuse('&a h = '''//repeat('''''', 9000)//''' /', 'is longer than')
   end subroutine test_errors

   subroutine refuse(text, message)
      character(*), intent(in) :: text
      character(*), intent(in) :: message
      !! required part of the message
      type(error_t), allocatable :: error
      type(group_t), allocatable :: groups(:)

      call parse_namelist(text, groups, error)
      call checks%has_error(error, err_input, message, 'refused: '//text(:min(30, len(text))))
   end subroutine refuse

end program test_namelist
