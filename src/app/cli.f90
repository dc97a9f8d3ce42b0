!> Command line of the batch program.
module rwmf_app_cli
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_strings, only: string_t
   implicit none
   private

   public :: command_line_t, read_command_line, usage

   character(1), parameter :: nl = new_line('a')
   character(*), parameter :: usage = &
      'usage: rwmf-batch CASE.nml [CASE2.nml ...] [--out DIR] [--part K/N]'//nl//nl &
      //'Seismic response of post-tensioned rocking wall-moment frames.'//nl//nl &
      //'Every file is checked before the first one runs. A case writes'//nl &
      //'   CASE.summary.csv    maxima and counts of the response in time'//nl &
      //'   CASE.history.csv    the response in time, when &output gives dt'//nl &
      //'   CASE.spectrum.csv   maxima over the frame period, with &spectrum'//nl//nl &
      //'options:'//nl &
      //'   --out DIR    existing folder for the files (default: the current one)'//nl &
      //'   --part K/N   only the K-th of N parts of the periods of &spectrum, into'//nl &
      //'                CASE.part-K-of-N.spectrum.csv; rwmf merge joins the parts'//nl &
      //'   --version    print the version and leave'//nl &
      //'   --help       print this and leave'//nl//nl &
      //'example:'//nl &
      //'   rwmf-batch inputs/fig12_one_cosine.nml --out results'//nl//nl &
      //'OMP_NUM_THREADS bounds the threads of a spectrum; more than 256, and than 16'//nl &
      //'for each processor, are refused.'//nl &
      //'exit status: 0 done (overturning and collapse are results), 1 numerical failure,'//nl &
      //'   2 input or output not acceptable, 130 interrupted'
   !! output of `--help`

   !> Parsed command line.
   type :: command_line_t
      type(string_t), allocatable :: cases(:)
      !! (files) namelists in the order given
      character(:), allocatable :: folder
      !! folder of the results; '' is the current one
      integer :: part
      !! number of the part of a spectrum's periods, from 1
      integer :: parts
      !! number of parts; 1: all periods
      logical :: help
      logical :: version
   end type command_line_t

contains

   !> Read the arguments. Fails for an unknown option, `--out` without a folder, no case.
   subroutine read_command_line(command_line, error)
      type(command_line_t), intent(out) :: command_line
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: given
      logical :: options_end
      integer :: i

      allocate (command_line%cases(0))
      command_line%folder = ''
      command_line%part = 1
      command_line%parts = 1
      command_line%help = .false.
      command_line%version = .false.
      options_end = .false.
      i = 0
      do while (i < command_argument_count())
         call take_argument(i, given)
         if (options_end .or. index(given, '-') /= 1) then
            command_line%cases = [command_line%cases, string_t(given)]
         else if (given == '--') then
            options_end = .true.
         else
            call read_option(command_line, given, i, error)
            if (allocated(error)) return
         end if
      end do
      if (command_line%help .or. command_line%version) return
      if (size(command_line%cases) == 0) then
         call fail(error, err_input, 'no case is given: rwmf-batch CASE.nml [CASE2.nml ...]')
      end if
   end subroutine read_command_line

   !> Read one option with its value.
   subroutine read_option(command_line, option, position, error)
      type(command_line_t), intent(inout) :: command_line
      character(*), intent(in) :: option
      !! option as typed by the user
      integer, intent(inout) :: position
      !! position of the option; on return of its value, if it has one
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: value

      select case (option)
      case ('-h', '--help')
         command_line%help = .true.
      case ('--version')
         command_line%version = .true.
      case ('-o', '--out')
         call take_argument(position, command_line%folder)
         if (len(command_line%folder) == 0) then
            call fail(error, err_input, option//' needs a folder')
         end if
      case ('--part')
         call take_argument(position, value)
         call read_part(value, command_line, error)
      case default
         if (index(option, '--out=') == 1 .and. len(option) > len('--out=')) then
            command_line%folder = option(len('--out=') + 1:)
         else
            call fail(error, err_input, 'unknown option '//option &
               //'; allowed: --out DIR, --part K/N, --help, --version')
         end if
      end select
   end subroutine read_option

   !> Return the next argument in its full length; empty after the last one.
   subroutine take_argument(position, text)
      integer, intent(inout) :: position
      !! position of the previous argument; on return of this one
      character(:), allocatable, intent(out) :: text
      integer :: length
      integer :: status

      position = position + 1
      call get_command_argument(position, length=length, status=status)
      allocate (character(length) :: text)
      if (status == 0 .and. length > 0) call get_command_argument(position, text)
   end subroutine take_argument

   !> Read the value of `--part`, K/N with 1 <= K <= N.
   subroutine read_part(text, command_line, error)
      character(*), intent(in) :: text
      type(command_line_t), intent(inout) :: command_line
      type(error_t), allocatable, intent(out) :: error
      integer :: slash
      integer :: status

      slash = index(text, '/')
      status = 1
      ! digits only: a list-directed read would also accept '1,5' or '2*3'
      if (slash > 1 .and. slash == index(text, '/', back=.true.) &
         .and. verify(text, '0123456789/') == 0) then
         read (text(:slash - 1), *, iostat=status) command_line%part
         if (status == 0) read (text(slash + 1:), *, iostat=status) command_line%parts
      end if
      if (status == 0) then
         if (command_line%part >= 1 .and. command_line%part <= command_line%parts) return
      end if
      call fail(error, err_input, '--part '//text//': must be K/N with 1 <= K <= N, as in 3/16')
   end subroutine read_part

end module rwmf_app_cli
