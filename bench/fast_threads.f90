!> What a second thread gains in a host that keeps its threads, as Fortran programs do.
!>
!>    fast_threads CASE.nml [N ...]    the spectrum of the case, then with N periods from 0.05 to
!>                                     3 s at its first mass ratio; one row of a table each
program fast_threads
   use, intrinsic :: iso_fortran_env, only: int64
   use rwmf, only: case_t, compute_spectrum, error_t, read_case_file, spectrum_t, wp
   implicit none
   integer, parameter :: repeats = 9
   !! of which the fastest counts, one and two threads in turn
   character(1000) :: path
   character(16) :: word
   type(case_t) :: case
   type(error_t), allocatable :: error
   integer :: i, n

   call get_command_argument(1, path)
   call read_case_file(trim(path), case, error)
   if (allocated(error)) then
      print '(a)', error%message
      error stop 'usage: fast_threads CASE.nml [N ...]'
   end if
   print '(a)', '| ordinates | 1 thread, ms | 2 threads, ms | ratio |'
   print '(a)', '|---|---|---|---|'
   call measure(case)
   if (allocated(case%spectrum%gamma)) case%spectrum%gamma = case%spectrum%gamma(:1)
   if (allocated(case%spectrum%b)) case%spectrum%b = case%spectrum%b(:1)
   do i = 2, command_argument_count()
      call get_command_argument(i, word)
      read (word, *) n
      case%spectrum%T_s = periods(n)
      call measure(case)
   end do

contains

   pure function periods(n) result(T_s)
      integer, intent(in) :: n
      real(wp) :: T_s(n)
      !! [s]
      integer :: k

      T_s = [(0.05_wp + 2.95_wp*(k - 1)/max(1, n - 1), k=1, n)]
   end function periods

   subroutine measure(scene)
      type(case_t), intent(in) :: scene
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: failure
      real(wp) :: best(2)
      !! [ms]
      integer(int64) :: begin, end, rate
      integer :: k, threads

      best = huge(1.0_wp)
      do k = 1, repeats
         do threads = 1, 2
            call system_clock(begin, rate)
            call compute_spectrum(scene, threads, spectrum, failure)
            call system_clock(end)
            if (allocated(failure)) error stop 'a spectrum failed'
            best(threads) = min(best(threads), 1.0e3_wp*real(end - begin, wp)/real(rate, wp))
         end do
      end do
      print '(a,i0,2(a,f0.2),a,f0.2,a)', '| ', size(spectrum%values), ' | ', best(1), ' | ', &
         best(2), ' | ', best(1)/best(2), ' |'
   end subroutine measure

end program fast_threads
